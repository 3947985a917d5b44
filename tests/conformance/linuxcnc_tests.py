#!/usr/bin/env python3
"""Runs LinuxCNC's own interpreter tests with pitchlock in the place of rs274.

    linuxcnc_tests.py ../linuxcnc                    a source tree of LinuxCNC; its tests are not part of this repository
    linuxcnc_tests.py ../linuxcnc --as-2.10          tests of 2.9: tool changes are expected as 2.10 prints them
    linuxcnc_tests.py ../linuxcnc --only g76 --diff  some of them, with what differs

Every folder below tests/ counts whose script calls rs274; interp/bad and interp/good count file by file. Left out are
those that need Python, remaps, plug-ins for the interpreter, or a user interface. As in LinuxCNC, a script must end
with status 0 and print what its file `expected` holds, byte for byte; a bad program must be refused. A script that
names no tool table gets the one that rs274 has built in. Standard library only.
"""
import argparse, difflib, os, re, shutil, subprocess, sys, tempfile
from pathlib import Path

OUT = re.compile(r"^remap/|^interp/(plug|pymove|python|value-returned|compile)\b")
USER_INTERFACE = re.compile(r"^\s*(exec\s+)?linuxcnc\b|\bhalrun\b", re.M)
REMAP = re.compile(r"^\s*(REMAP\s*=|\[PYTHON\])", re.M)

def read(path):
    return path.read_text(errors="replace") if path.exists() else ""

def wanted(tests):
    """Folder and script of the tests that count."""
    for path in sorted(tests.rglob("test*")):
        name, text = path.parent.relative_to(tests).as_posix(), read(path) if path.name in ("test", "test.sh") else ""
        if not re.search(r"\brs274\b", text) or OUT.search(name) or USER_INTERFACE.search(text):
            continue
        if not any(REMAP.search(read(ini)) for ini in path.parent.glob("*.ini")):
            yield name, path

def run(command, folder, path):
    try:
        done = subprocess.run(command, cwd=folder, env=dict(os.environ, PATH=path, LC_ALL="C"), timeout=60,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout.decode(errors="replace")

def as_2_10(text):
    text = re.sub(r"^.*START_CHANGE\(\)\n", "", text, flags=re.M)
    return re.sub(r"CHANGE_TOOL\(\d+\)", "CHANGE_TOOL()", text)

def judge(name, script, scratch, path, adapt):
    """(name, expected, got) of a test or of the files of a folder; text that is None was not to be had."""
    folder = scratch / name
    shutil.copytree(script.parent, folder, symlinks=True)
    if name in ("interp/bad", "interp/good"):
        for program in sorted(folder.glob("*.ngc")):
            status, text = run(["rs274", "-g", program.name], folder, path)
            if name == "interp/bad":
                yield f"{name}/{program.name}", "refused", "refused" if status in range(1, 101) else str(status)
            else:
                expected = adapt(read(folder / (program.name + ".expected")))
                yield f"{name}/{program.name}", expected, text if status == 0 else f"status {status}"
        return
    status, text = run(["bash", script.name], folder, path)
    if (folder / "result").exists():
        text = text or read(folder / "result")
    if status == 0 and (folder / "checkresult").exists():
        (folder / "result").write_text(text)
        status, text = run(["./checkresult", "result"], folder, path)
        yield name, "0", str(status)
    else:
        yield name, adapt(read(folder / "expected")), text if status == 0 else f"status {status}"

def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, help="source tree of LinuxCNC, or a folder with its tests/")
    parser.add_argument("--cmd", default="pitchlock canon --format linuxcnc")
    parser.add_argument("--tools", type=Path, help="tool table where a test names none; configs/common/tool.tbl")
    parser.add_argument("--only", default="", help="tests whose name contains this")
    parser.add_argument("--as-2.10", dest="new", action="store_true")
    parser.add_argument("--diff", action="store_true")
    args = parser.parse_args()
    tools = args.tools or args.source / "configs/common/tool.tbl"
    passed = count = 0
    with tempfile.TemporaryDirectory() as scratch:
        shim = Path(scratch) / "bin" / "rs274"
        shim.parent.mkdir()
        table = f"-t '{tools.resolve()}' " if tools.exists() else ""
        shim.write_text(f'#!/bin/sh\ncase " $*" in *" -t"*) exec {args.cmd} "$@";; esac\nexec {args.cmd} {table}"$@"\n')
        shim.chmod(0o755)
        path = f"{shim.parent}:{os.environ['PATH']}"
        for name, script in wanted(args.source / "tests"):
            if args.only not in name and name not in ("interp/bad", "interp/good") or (script.parent / "skip").exists():
                continue
            adapt = as_2_10 if args.new else lambda text: text
            for name, expected, got in judge(name, script, Path(scratch) / "run", path, adapt):
                if args.only in name:
                    count, passed = count + 1, passed + (expected == got)
                    print("ok  " if expected == got else "FAIL", name)
                    if args.diff and expected != got:
                        sides = expected.splitlines(), got.splitlines()
                        print("\n".join(difflib.unified_diff(*sides, "expected", "got", n=1, lineterm="")))
    print(f"{passed} of {count} pass" + (f", {100 * passed / count:.1f} %" if count else ""))
    return passed != count

if __name__ == "__main__":
    sys.exit(main())
