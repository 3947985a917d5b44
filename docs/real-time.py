#!/usr/bin/env python3
"""Real time on this computer, beside cyclictest: the table of docs/figures.md.

Runs examples/m20x2.ngc with --clock real and cyclictest in turns, with a load beside both, and prints a row for
each pair and their medians. As administrator. Needs cyclictest (rt-tests) and stress-ng.

    docs/real-time.py [PITCHLOCK] [PAIRS]      default: target/release/pitchlock, 10
"""

import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

CYCLE_US = 500
# A wake-up so late has three cycles in a row late by more than a quarter of one.
THREE_US = 2 * CYCLE_US + CYCLE_US // 4
SECONDS = 15
DEEPEST_US = 20_000


def cyclictest():
    """Median, 99 % and worst in us, and how often three cycles in a row were late."""
    words = ["cyclictest", "-m", "-q", "-p", "80", "-i", str(CYCLE_US), "-D", str(SECONDS), "-h", str(DEEPEST_US)]
    text = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    counts = {}
    worst = 0
    for line in text.splitlines():
        if line.startswith("# Max Latencies:"):
            worst = int(line.split()[-1])
        elif line and not line.startswith("#"):
            at, count = line.split()[:2]
            counts[int(at)] = int(count)
    total = sum(counts.values())

    def quantile(share):
        seen = 0
        for at in sorted(counts):
            seen += counts[at]
            if seen >= share * total:
                return at
        return worst

    late = sum(count for at, count in counts.items() if at > THREE_US)
    return quantile(0.5), quantile(0.99), worst, late + (worst > DEEPEST_US)


def machine(pitchlock, folder):
    """Median, 99 % and worst wake-up in us, time on the machine, late answers in a row, late ticks of the
    interpolator, page faults, its end."""
    words = [pitchlock, "run", "examples/m20x2.ngc", "--clock", "real", "--trace", "none", "--quiet", "--out", folder]
    subprocess.run(words, capture_output=True, check=False)
    summary = json.loads((Path(folder) / "summary.json").read_text())
    of = {one["process"]: one for one in summary["real_time"]}
    wake, ticks = of["real-time"]["wake_up"], of["interpolator"]["late_in_all"]
    row = max(channel.get("late_in_row", 0) for channel in summary["channels"])
    faults = sum(one["system"]["minor_faults"] + one["system"]["major_faults"] for one in summary["real_time"])
    end = summary["faults"][0]["code"] if summary["faults"] else summary["outcome"]
    return wake["median_us"], wake["p99_us"], wake["most_us"], summary["simulated_s"], row, ticks, faults, end


def main():
    pitchlock = sys.argv[1] if len(sys.argv) > 1 else "target/release/pitchlock"
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    load = subprocess.Popen(["stress-ng", "--cpu", "1", "--quiet"])
    try:
        print("| pair | machine: median, 99 %, worst | late in a row | ticks late | page faults | it ran | ended by "
              "| cyclictest: median, 99 %, worst | three cycles late | 99 %, ratio |")
        print("|---" * 10 + "|")
        ratios = []
        with tempfile.TemporaryDirectory() as place:
            for pair in range(1, pairs + 1):
                p50, p99, worst, ran, row, ticks, faults, end = machine(pitchlock, f"{place}/{pair}")
                c50, c99, cworst, late = cyclictest()
                ratios.append(p99 / c99)
                print(f"| {pair} | {p50}, {p99}, {worst} us | {row} | {ticks} | {faults} | {ran:.1f} s | `{end}` "
                      f"| {c50}, {c99}, {cworst} us | {late} | {p99 / c99:.2f} |", flush=True)
        print(f"\nmedian of the ratios: {statistics.median(ratios):.2f}")
    finally:
        load.terminate()
        load.wait()


if __name__ == "__main__":
    main()
