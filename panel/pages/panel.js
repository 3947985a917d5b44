"use strict";
// The panel of pitchlock. It shows what the server sends and asks for what somebody presses; docs/panel.md is
// the reference of both. The secret stands behind # in the address, so that it is sent to nobody but here.
const $ = (id) => document.getElementById(id);
const token = location.hash.slice(1) || sessionStorage.getItem("token") || "";
sessionStorage.setItem("token", token);
history.replaceState(null, "", location.pathname);
const me = sessionStorage.getItem("me") || "browser-" + Math.random().toString(36).slice(2, 6);
sessionStorage.setItem("me", me);

let state = {}, trail = [], socket = null, asked = 0, ofWork = true, drawn = false;
const waits = new Map();

function connect() {
  socket = new WebSocket(`ws://${location.host}/api/live`, ["pitchlock.panel.1", "token." + token]);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { lamp("live", "on"); wanted(); };
  socket.onmessage = (event) => (event.data instanceof ArrayBuffer ? scopePicture(event.data) : take(JSON.parse(event.data)));
  socket.onclose = () => {
    lamp("not connected", "off");
    for (const [, told] of waits) told({ refused: "gone", why: "the panel is not connected" });
    waits.clear();
    setTimeout(connect, 1000);
  };
}
function lamp(text, kind) {
  $("link").textContent = text;
  $("link").className = "lamp " + kind;
  // What is below is the last that was seen, and looks so.
  document.body.classList.toggle("gone", kind === "off");
  keys();
}

function take(news) {
  if ("id" in news) {
    const told = waits.get(news.id);
    waits.delete(news.id);
    if (told) told(news);
    return;
  }
  if (news.scope) return scopeTold(news.scope);
  if (news.trail) {
    trail.length = news.trail.from;
    for (const point of news.trail.points) trail.push(point);
    delete news.trail;
  }
  Object.assign(state, news);
  show(news);
}

function ask(word, value) {
  const request = { id: ++asked, do: word, as: me };
  if (value !== undefined) request.value = value;
  return new Promise((resolve) => {
    if (!socket || socket.readyState !== 1) return resolve({ refused: "gone", why: "the panel is not connected" });
    waits.set(request.id, resolve);
    socket.send(JSON.stringify(request));
  });
}
async function press(word, value) {
  const answer = await ask(word, value);
  const plain = (value) => (value instanceof Object ? Object.values(value).map(plain).join(" ") : value);
  say(answer.refused ? `${word}: ${answer.why}` : `${value === undefined ? word : word + " " + plain(value)}: in cycle ${answer.cycle}`, answer.refused);
}
// On a telephone it is said beside the keys that stay on the screen as well.
function say(text, refused) {
  for (const said of [$("said"), $("heard")]) {
    said.className = refused ? "no" : "";
    said.textContent = text;
  }
}

const number = (value, digits) => (value === undefined || value === null ? "–" : Number(value.toFixed(digits)).toFixed(digits));
const hand = {};
const clock = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;
const origin = () => state.origin_mm || state.machine?.origin_mm;

function show(news) {
  if (news.outcome === null) say("");
  if (news.machine || news.program) {
    const machine = state.machine || {}, program = state.program || {};
    $("machine").textContent = machine.name || "pitchlock";
    $("program").textContent = [program.name, program.folder, machine.pace && "pace " + machine.pace].filter(Boolean).join(" · ");
    document.title = (program.name || "pitchlock") + " · pitchlock";
  }
  if (news.program) text();
  if (news.machine) jogs();
  if ("mode" in news || "by_hand" in news) hands();
  if ("by_hand" in news && !state.program?.text) text();
  if (news.offsets || news.machine) offsets();
  if (news.playback || "time_s" in news && state.playback) player();
  if ("seat" in news) keys();
  if ("from" in news) begins();
  const why = state.outcome === "faulted" && state.faults?.[0] ? ": " + state.faults[0].text : "";
  $("words").textContent = state.outcome && state.state === "ready" ? `${state.outcome}${why}; ${state.words}` : state.words || "–";
  if ("part" in news) part();
  const kind = { fault: "fault", "emergency-stop": "fault", held: "held", holding: "holding", paused: "paused", "tool-change": "paused" }[state.state];
  document.querySelector(".state").className = "state " + (kind || (["ready", "ended"].includes(state.state) ? "" : "run"));
  const parts = [];
  if (typeof state.time_s === "number") parts.push(number(state.time_s, 1) + " s on the machine", "cycle " + state.cycle);
  if (state.pass) parts.push(`pass ${state.pass}${state.by_hand ? "" : ` of ${state.program?.passes ?? "?"}`}${state.depth_mm ? `, depth ${number(state.depth_mm, 3)} mm` : ""}`);
  if (state.left_s !== undefined && state.left_s !== null && state.state !== "ready" && !state.by_hand) parts.push(clock(state.left_s) + " to go at 100 %");
  if (state.tool) parts.push(["T" + state.tool, state.tool_name].filter(Boolean).join(" "));
  if (origin()) parts.push(`zero of the program at ${lathe() ? "X⌀ " + number(2 * origin()[0], 3) : "X " + number(origin()[0], 3)} Z ${number(origin()[1], 3)} of the machine`);
  if (state.coolant) parts.push(state.coolant);
  if (state.recording === false) parts.push("too many presses: this session cannot be repeated");
  $("where").textContent = parts.join(" · ");
  $("prompt").hidden = !state.prompt;
  if ($("prompt").textContent !== (state.prompt || "")) $("prompt").textContent = state.prompt || "";
  $("tool-in").hidden = state.mode !== "tool-change";
  $("tool-in").textContent = state.tool ? `T${state.tool} is in` : "It is out";
  $("done").style.width = (state.done ? 100 * state.done[0] / Math.max(1, state.done[1]) : 0) + "%";
  if (news.axes) axes();
  if (news.spindle) {
    const spindle = state.spindle;
    $("rpm").textContent = number(spindle.rpm, 0);
    $("spindle").textContent = `commanded ${number(spindle.commanded_rpm, 0)} · ${number(spindle.angle_deg, 0)}° · ${number(spindle.torque_nm, 1)} N·m, load ${number(spindle.load_pct, 0)} %`;
  }
  if (news.knobs) knobs();
  if ("single_block" in news) $("single").checked = state.single_block;
  if ("optional_stop" in news) $("optional").checked = state.optional_stop;
  if ("line" in news) mark();
  if (news.passes || "cutting" in news) passes();
  if (news.faults || news.messages) told();
  scopeNews(news);
  if (!drawn) { drawn = true; requestAnimationFrame(() => { drawn = false; draw(); }); }
}

function keys() {
  const mine = state.seat === me, live = socket && socket.readyState === 1;
  $("seat").textContent = mine ? "You hold the keys" : state.seat ? `${state.seat} holds the keys: you watch` : "Nobody holds the keys";
  $("take").textContent = mine ? "Give them back" : state.seat ? "Take over" : "Take the keys";
  $("take").disabled = !live;
  for (const key of document.querySelectorAll("#tool-in,.keys button,.keys input,.knobs input,.urgent button")) key.disabled = !mine || !live || !!state.playback;
  for (const key of document.querySelectorAll(".player button,.player input")) key.disabled = !mine || !live;
  hands();
}

const lathe = () => state.machine?.kinematics === "lathe";
function axes() {
  const work = ofWork && origin(), across = lathe() && ofWork ? 2 : 1;
  const rows = state.axes.map((axis) => {
    const zero = work ? (axis.name === "X" ? work[0] : axis.name === "Z" ? work[1] : 0) : 0;
    const factor = axis.name === "X" ? across : 1;
    const cell = (mm) => number((mm - zero) * factor, 3);
    const name = axis.name === "X" && factor === 2 ? "X ⌀" : axis.name;
    return [name, cell(axis.measured_mm), axis.to_go_mm === null || axis.to_go_mm === undefined ? "–" : number(axis.to_go_mm * factor, 3),
      cell(axis.commanded_mm), number(axis.error_um, 1) + " µm", number(axis.load_pct, 0) + " %"];
  });
  fill($("axes"), rows);
  state.axes.forEach((axis, at) => {
    const [low, high] = state.machine?.travel?.[at] || [-Infinity, Infinity], mm = axis.measured_mm, beyond = mm < low - 0.1 || mm > high + 0.1;
    const row = $("axes").tBodies[0].rows[at];
    row.className = (axis.referenced === false ? "lost" : "") + (beyond ? " beyond" : "");
    row.title = beyond ? `${axis.name} is beyond its travel of ${low} to ${high} of the machine` : "";
  });
  $("frame").textContent = ofWork ? (origin() ? "Work" : "Machine, ⌀") : "Machine";
}
function fill(table, rows) {
  const body = table.tBodies[0];
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((cells, at) => {
    const row = body.rows[at] || body.insertRow();
    cells.forEach((cell, column) => {
      const place = row.cells[column] || row.insertCell();
      if (place.textContent !== String(cell)) place.textContent = cell;
    });
  });
}
function part() {
  const { verdict, words, report } = state.part || {};
  $("part").hidden = !state.part;
  $("part").className = verdict || "";
  const of = { good: "The part is good.", bad: "The part is not good.", none: "The part is not judged." }[verdict];
  $("part").textContent = state.part ? [of, ...words.map((text) => text.replace(/[.]?$/, ".")), `Report: ${report}`].join(" ") : "";
}
function knobs() {
  for (const [name, inForce] of [["spindle", true], ["feed", true], ["rapid", false]]) {
    const at = state.knobs[name + "_pct"], force = state.knobs[name + "_in_force_pct"];
    const slider = $(name + "-override");
    if (!hand[name]) slider.value = at;
    $(name + "-now").textContent = inForce && Math.abs(force - at) > 0.5 ? `${number(at, 0)} %, in force ${number(force, 0)} %` : number(at, 0) + " %";
  }
}
function text() {
  const pre = $("text");
  pre.textContent = "";
  const source = state.program?.text;
  if (!source) { pre.textContent = state.by_hand || state.program?.name === "by-hand.mc" ? "Work by hand" : state.program?.folder ? "The program is too long to be shown, or machine code." : ""; return; }
  source.split("\n").forEach((line, at) => {
    const row = document.createElement("div"), label = document.createElement("b");
    label.textContent = at + 1;
    row.append(label, line);
    row.onclick = () => pick(at + 1);
    pre.append(row);
  });
  mark();
  pick(0);
}
// Where the next start begins: a line is pressed, then chosen, and what is in force there is shown.
let picked = 0;
function pick(line) {
  $("text").querySelector(".picked")?.classList.remove("picked");
  picked = line === picked ? 0 : line;
  if (picked) $("text").children[picked - 1].classList.add("picked");
  begins();
}
function begins() {
  const from = state.from, may = state.seat === me && socket && socket.readyState === 1 && state.mode === "off";
  $("from-here").hidden = !may || !picked;
  $("from-here").textContent = `Begin at line ${picked}`;
  $("from").hidden = !from;
  $("from-start").disabled = !may;
  document.querySelector("[data-do=start]").textContent = from && state.mode === "off" ? `Start at line ${from.from}` : "Start";
  if (!from) return;
  const first = from.line === from.from ? "" : `, the first move is that of line ${from.line}`, variables = Object.entries(from.variables);
  $("from-line").textContent = `${state.mode === "off" ? "Start begins" : "Begun"} at line ${from.from}${first}${from.pass ? `, with pass ${from.pass}, whole` : ""}`;
  const zero = Object.entries(from.zero_mm).filter(([, mm]) => mm !== null).map(([axis, mm]) => `${axis.toUpperCase()} ${number(mm, 3)}`).join(" ");
  const told = [from.words, from.in_force, `zero of system ${from.system}: ${zero} of the machine`, ...from.way.map((move) => "way " + move)];
  if (variables.length) told.push(variables.slice(0, 12).map(([name, value]) => `${name} = ${value}`).join(", ") + (variables.length > 12 ? ` and ${variables.length - 12} more` : ""));
  if (from.in_loop) told.push("the line is in a loop: it begins in its first turn");
  told.push(...from.not_known.map((what) => "nobody knows " + what));
  $("from-told").replaceChildren(...told.map((text) => { const item = document.createElement("li"); item.textContent = text; return item; }));
}
function mark() {
  const pre = $("text"), row = pre.children[state.line - 1];
  pre.querySelector(".now")?.classList.remove("now");
  if (!row || !state.line || state.blocks) return;
  row.classList.add("now");
  pre.scrollTop = row.offsetTop - pre.offsetTop - pre.clientHeight / 2;
}
function passes() {
  $("of").textContent = state.program?.passes && state.passes ? `${state.passes.length} of ${state.program.passes}` : "";
  const now = state.cutting ? [state.cutting] : [];
  fill($("passes"), [...now, ...(state.passes || []).slice().reverse()].map((pass) => [pass.pass, pass.depth_mm ? number(pass.depth_mm, 3) : "–",
    `${number(pass.rpm[0], 0)}–${number(pass.rpm[1], 0)}`, pass.cut ? number(pass.helix_um, 1) : "no contact",
    pass.cut ? number(pass.phase_um, 1) : "", pass.end]));
  const first = $("passes").tBodies[0].rows[0];
  if (first) first.className = now.length ? "now" : "";
}
function told() {
  const list = $("told");
  list.textContent = "";
  const say = (kind, head, more) => {
    const item = document.createElement("li"), small = document.createElement("small");
    item.className = kind;
    small.textContent = more;
    item.append(head, small);
    list.append(item);
  };
  // What several have found at once is one.
  const found = new Map();
  for (const fault of state.faults || []) found.set(fault.code + fault.text, [...(found.get(fault.code + fault.text) || []), fault]);
  for (const [fault, ...others] of found.values()) {
    const sources = [fault, ...others].map((one) => one.source).filter((source, at, all) => all.indexOf(source) === at).join(", ");
    say("fault", `${sources} ${fault.code}: ${fault.text}`, (fault.remedy ? "look at: " + fault.remedy.replaceAll("`", "") : "") + ` (cycle ${fault.cycle})`);
  }
  for (const message of [...(state.messages || [])].reverse()) say("", message.text, `${state.blocks ? "block" : "line"} ${message.line}`);
  if (!list.children.length) say("", "none", "");
}

// Work by hand.
function hands() {
  const may = state.seat === me && socket && socket.readyState === 1, ready = may && state.mode === "ready";
  $("mode").textContent = state.mode || "";
  $("force").textContent = state.by_hand ? "in force: " + state.by_hand.in_force : "Switched on by hand, the machine jogs and takes blocks. Stop or abort switches it off.";
  $("hand-on").disabled = !may || state.mode !== "off";
  for (const key of document.querySelectorAll("#mdi button,#touch button,#turn button")) key.disabled = !ready;
  for (const key of document.querySelectorAll("#offset button")) key.disabled = !ready && !(may && state.mode === "off");
  // A key that is held down stays one.
  for (const key of document.querySelectorAll("#jogs button")) key.disabled = !ready && jogging !== key;
  begins();
}
let jogging = null, beats = null;
function jogs() {
  const house = $("jogs"), axes = state.machine.axes || [];
  if (house.dataset.of === axes.join()) return;
  house.dataset.of = axes.join();
  house.textContent = "";
  $("touch-axis").textContent = "";
  axes.forEach((axis, at) => {
    const name = document.createElement("span");
    name.textContent = axis === "X" && lathe() ? "X radius" : axis;
    house.append(name);
    for (const way of ["-", "+"]) {
      const key = document.createElement("button");
      key.type = "button";
      key.id = `jog-${axis}${way === "+" ? "-plus" : "-minus"}`;
      key.textContent = (way === "+" ? "+" : "−") + axis;
      key.onpointerdown = () => jog(key, axis, way, at);
      key.onpointerup = key.onpointercancel = key.onpointerleave = key.onblur = letGo;
      key.oncontextmenu = () => false;
      house.append(key);
    }
    const home = document.createElement("button");
    home.type = "button";
    home.id = "home-" + axis;
    home.textContent = "Home";
    home.title = `${axis} makes its reference run, or goes to its home in rapid motion`;
    home.onclick = () => press("home", axis);
    house.append(home);
    const choice = document.createElement("option");
    choice.textContent = axis;
    $("touch-axis").append(choice);
  });
  hands();
}
function jog(key, axis, way, at) {
  const step = Number($("step").value), feed = Number($("jog-feed").value);
  if (step) return press("jog", { axis, mm_min: feed, step_mm: way === "+" ? step : -step });
  jogging = key;
  press("jog", { axis, mm_min: Math.min(feed, state.machine.fastest_jog[at]), way });
  beats = setInterval(async () => {
    const answer = await ask("jog-on");
    if (answer.refused) letGo();
  }, 25);
}
function letGo() {
  if (!jogging) return;
  clearInterval(beats);
  jogging = beats = null;
  ask("let-go");
  hands();
}

// A recording.
let sought = false;
function player() {
  const { of, speed, until_s, outcome, changed, same } = state.playback;
  document.querySelector(".player").hidden = false;
  document.body.className = "recording";
  document.title = "recording · " + of;
  $("playback").textContent = `${of}, ${outcome}: ${number(state.time_s ?? 0, 3)} of ${number(until_s, 3)} s, cycle ${state.cycle ?? 0}, ${speed ? speed + " times as fast" : speed === 0 ? "stands" : "goes there"}.`;
  const other = [changed.length ? `The folder was changed: ${changed.join(", ")} not as in the run that was recorded.` : "",
    same === false ? "At its end it is another run than the recorded one: pitchlock replay says where they differ." : same ? "To its end it is bit for bit what was recorded." : ""];
  $("other").textContent = other.filter(Boolean).join(" ");
  $("other").className = same === false || changed.length && !same ? "no" : "";
  $("play").textContent = speed ? "Pause" : "Play";
  $("seek").max = until_s;
  if (!sought) $("seek").value = state.time_s ?? 0;
  keys();
}

// Offsets and tools: X of a lathe is shown as a diameter.
const across = (letter) => (letter === "X" && lathe() ? 2 : 1);
function offsets() {
  const all = state.offsets || {}, unit = all.units || "mm", letters = (state.machine?.axes || ["X", "Z"]).filter((name) => "XYZABC".includes(name));
  $("kept").textContent = all.unknown || [all.parameters, all.tools].filter(Boolean).join(" · ") || "no parameter file, no tool table";
  $("left-out").textContent = all.tools_left_out ? `${all.tools_left_out} more tools of the table are not shown here: pitchlock offsets list has them.` : "";
  const title = (letter) => (across(letter) === 2 ? letter + "⌀" : letter), words = [...letters, ...(lathe() ? ["D", "Q"] : ["D"])];
  const head = (table, names) => {
    const row = document.createElement("tr");
    for (const name of names) { const cell = document.createElement("th"); cell.textContent = name; row.append(cell); }
    $(table).tHead.replaceChildren(row);
  };
  head("systems", ["Zero", ...letters.map(title)]);
  head("tools", ["Tool", ...words.map(title), ""]);
  const value = (row, letter) => (letter === "Q" ? row.Q : number(across(letter) * row[letter], unit === "inch" ? 5 : 4));
  const used = (all.systems || []).filter((row, at) => at < 2 || row.name === all.in_force || Object.values(row).some((value) => typeof value === "number" && value));
  fill($("systems"), used.map((row) => [row.name + (row.name === all.in_force ? " in force" : ""), ...letters.map((letter) => value(row, letter))]));
  fill($("tools"), (all.tool_offsets || []).map((row) => ["T" + row.number, ...words.map((letter) => value(row, letter)), row.comment]));
  const choose = (id, names) => {
    const before = $(id).value;
    $(id).replaceChildren(...names.map(([value, text]) => new Option(text, value)));
    if (names.some(([value]) => value === before)) $(id).value = before;
  };
  const tools = (all.tool_offsets || []).map((row) => ["T" + row.number, "T" + row.number]);
  choose("offset-of", [...tools, ...(all.systems || []).map((row) => [row.name, row.name])]);
  choose("touch-into", [["", all.in_force || "G54"], ...tools.map(([name]) => [name.slice(1), name])]);
  for (const [table, of] of [["systems", used.map((row) => row.name)], ["tools", tools.map(([name]) => name)]])
    [...$(table).tBodies[0].rows].forEach((row, at) => { row.onclick = () => { $("offset-of").value = of[at]; chosen(); }; });
  chosen();
}
function chosen() {
  const of = $("offset-of").value, all = state.offsets || {}, tool = of.startsWith("T"), before = $("offset-word").value;
  const letters = (state.machine?.axes || ["X", "Z"]).filter((name) => "XYZABC".includes(name)), words = tool ? [...letters, "D", "I", "J", "Q"] : [...letters, "R"];
  $("offset-word").replaceChildren(...words.map((letter) => new Option(across(letter) === 2 ? "X⌀" : letter, letter)));
  if (words.includes(before)) $("offset-word").value = before;
  for (const row of document.querySelectorAll(".pair tbody tr")) row.className = row.cells[0].textContent.split(" ")[0] === of ? "now" : "";
  const when = tool ? `, in force from its next ${state.machine?.kinematics === "lathe" ? "G43 or T word" : "G43"}` : "";
  $("offset-note").textContent = of ? `${of} in ${all.units || "mm"}${when}. A part that is 0.05 too thick: correct X⌀ of the tool by −0.05.` : "";
  $("offset-note").hidden = !of || !lathe();
}
function setOffset(how) {
  const letter = $("offset-word").value;
  press("offset", { of: $("offset-of").value, [how]: { [letter]: Number($("offset-value").value) / across(letter) } });
}

// Views: a lathe has X over Z, others X–Y, X–Z and Y–Z.
function draw() {
  const machine = state.machine;
  if (!machine) return;
  const at = (name) => machine.axes.indexOf(name);
  const views = lathe() ? [["Z", "X"]] : [["X", "Y"], ["X", "Z"], ["Y", "Z"]].filter((pair) => pair.every((name) => at(name) >= 0));
  $("view-name").textContent = views.map((pair) => pair[1] + " over " + pair[0]).join(", ");
  const house = $("views");
  while (house.children.length > views.length) house.lastChild.remove();
  while (house.children.length < views.length) house.append(document.createElement("canvas"));
  // Each tool is drawn where it is at work on the part, which lies in one place.
  const moved = (name) => state.moved_mm?.[["X", "Z"].indexOf(name)] ?? 0;
  const here = state.axes?.map((axis) => axis.measured_mm + moved(axis.name));
  views.forEach(([right, up], number) => view(house.children[number], at(right), at(up), here, views.length > 1 ? 150 : 260));
}
function view(canvas, right, up, here, height) {
  const machine = state.machine, width = canvas.parentElement.clientWidth, scale = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = width * scale;
    canvas.height = height * scale;
    canvas.style.height = height + "px";
  }
  const pen = canvas.getContext("2d"), css = getComputedStyle(document.documentElement);
  const colour = (name) => css.getPropertyValue("--" + name);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  const zero = machine.origin_mm || origin() || [0, 0], stock = machine.stock, low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const see = (h, v) => { low[0] = Math.min(low[0], h); high[0] = Math.max(high[0], h); low[1] = Math.min(low[1], v); high[1] = Math.max(high[1], v); };
  const turned = lathe() && stock ? stock.rows_mm.map(([z, r]) => [z + zero[1], r + zero[0]]) : [];
  turned.forEach(([z, r]) => see(z, r));
  if (turned.length) see(turned[0][0], zero[0]);
  const way = state.way || [];
  // Where a part is known, it fills the picture; rapids lead out of it, and the tool waits at its edge.
  for (const [place, kind] of [...way, ...trail]) if (kind || !turned.length) see(place[right], place[up]);
  if (here && !turned.length) see(here[right], here[up]);
  if (!isFinite(low[0])) return;
  const wide = Math.max(high[0] - low[0], 5), tall = Math.max(high[1] - low[1], 5);
  const size = Math.min((width - 24) / wide, (height - 24) / tall);
  const h = (mm) => (width - wide * size) / 2 + (mm - low[0]) * size, v = (mm) => height - (height - tall * size) / 2 - (mm - low[1]) * size;
  const shape = (points, name) => {
    pen.fillStyle = colour(name);
    pen.beginPath();
    points.forEach(([a, b], at) => (at ? pen.lineTo(h(a), v(b)) : pen.moveTo(h(a), v(b))));
    pen.fill();
  };
  if (turned.length) {
    const inner = stock.inner_mm + zero[0], most = Math.max(...turned.map(([, r]) => r)), ends = [turned[0][0], turned[turned.length - 1][0]];
    shape([[ends[0], inner], ...turned, [ends[1], inner]], "stock");
    // What feeds have turned away, and the groove where each pass went through the index.
    const inside = (r) => stock.inner_mm > 0 && r < (inner + most) / 2, beyond = (r) => (inside(r) ? zero[0] : most + 1);
    pen.save();
    pen.beginPath();
    [[ends[0], inner], ...turned, [ends[1], inner]].forEach(([a, b], at) => (at ? pen.lineTo(h(a), v(b)) : pen.moveTo(h(a), v(b))));
    pen.clip();
    for (let at = 1; at < trail.length; at++) {
      const [[from], [to, kind]] = [trail[at - 1], trail[at]];
      if (kind === 1) shape([[from[right], from[up]], [to[right], to[up]], [to[right], beyond(to[up])], [from[right], beyond(from[up])]], "bg");
      if (kind !== 3) continue;
      const deep = Math.abs(beyond(to[up]) - to[up]), half = deep * Math.tan((machine.flanks_deg[state.tool] || machine.flanks_deg[0]) * Math.PI / 360);
      shape([[to[right], to[up]], [to[right] - half, beyond(to[up])], [to[right] + half, beyond(to[up])]], "bg");
    }
    pen.restore();
    if (stock.chuck_mm !== undefined) {
      const face = stock.chuck_mm + zero[1], grip = turned.find(([z]) => z >= face)?.[1] ?? most;
      shape([[low[0] - 50, grip], [face, grip], [face, grip + 12], [low[0] - 50, grip + 12]], "jaw");
    }
    pen.strokeStyle = colour("dim");
    pen.setLineDash([8, 4, 2, 4]);
    pen.beginPath(); pen.moveTo(0, v(zero[0])); pen.lineTo(width, v(zero[0])); pen.stroke();
    pen.setLineDash([]);
  }
  const path = (points, of, wide) => {
    for (let from = 0; from + 1 < points.length;) {
      const kind = Math.min(points[from + 1][1], 2);
      pen.strokeStyle = colour(of(kind));
      pen.lineWidth = kind ? wide : 1;
      pen.setLineDash(kind ? [] : [4, 3]);
      pen.beginPath();
      pen.moveTo(h(points[from][0][right]), v(points[from][0][up]));
      do { from++; pen.lineTo(h(points[from][0][right]), v(points[from][0][up])); } while (from + 1 < points.length && Math.min(points[from + 1][1], 2) === kind);
      pen.stroke();
    }
    pen.setLineDash([]);
  };
  path(way, () => "way", 1);
  path(trail, (kind) => ["rapid", "feed", "pass"][kind], 1.5);
  if (here) {
    const x = Math.min(Math.max(h(here[right]), 7), width - 7), y = Math.min(Math.max(v(here[up]), 14), height - 2);
    pen.fillStyle = colour("mark");
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x - 6, y - 12); pen.lineTo(x + 6, y - 12); pen.fill();
  }
  pen.fillStyle = colour("dim");
  pen.font = "11px system-ui";
  const step = 10 ** Math.floor(Math.log10(wide / 2));
  pen.fillRect(8, height - 7, step * size, 2);
  pen.fillText(step + " mm", 8, height - 11);
}

for (const key of document.querySelectorAll("[data-do]")) key.onclick = () => press(key.dataset.do);
$("mdi").onsubmit = (event) => { event.preventDefault(); press("mdi", $("block").value); };
$("touch").onsubmit = (event) => { event.preventDefault(); const into = $("touch-into").value; press("touch-off", { axis: $("touch-axis").value, value: Number($("touch-value").value), ...(into && { tool: Number(into) }) }); };
$("play").onclick = () => press("play", state.playback.speed ? 0 : Number($("speed").value));
$("speed").onchange = () => { if (state.playback.speed) press("play", Number($("speed").value)); };
$("step-one").onclick = () => press("step", 1);
$("step-many").onclick = () => press("step", Math.round(0.1 / state.machine.cycle_s));
$("seek").oninput = () => { sought = true; };
$("seek").onchange = () => { sought = false; press("seek", Number($("seek").value)); };
$("offset").onsubmit = (event) => { event.preventDefault(); setOffset("set"); };
$("offset-add").onclick = () => setOffset("add");
$("offset-of").onchange = chosen;
$("turn").onsubmit = (event) => { event.preventDefault(); press("spindle", Number($("turn-rpm").value)); };
$("tool-in").onclick = () => press("tool-change", state.tool);
$("from-here").onclick = () => press("from", picked);
$("from-start").onclick = () => press("from");
$("turn-stop").onclick = () => press("spindle", 0);
window.onblur = letGo;
$("single").onchange = (event) => press("single-block", event.target.checked);
$("optional").onchange = (event) => press("optional-stop", event.target.checked);
for (const name of ["spindle", "feed", "rapid"]) {
  const slider = $(name + "-override");
  let due = null;
  slider.oninput = () => {
    hand[name] = true;
    // While it is dragged, ten times a second are enough.
    if (!due) due = setTimeout(() => { due = null; press(name + "-override", Number(slider.value)); }, 100);
  };
  slider.onchange = () => setTimeout(() => { hand[name] = false; if (state.knobs) knobs(); }, 400);
}
$("take").onclick = () => press(state.seat === me ? "leave-seat" : "take-seat");
$("frame").onclick = () => { ofWork = !ofWork; if (state.axes) axes(); };
window.onresize = () => draw();
window.addEventListener("load", connect);
