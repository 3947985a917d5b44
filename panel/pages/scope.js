"use strict";
// The scope: every control cycle of the last minute, or of a recording. What is wanted goes to the server as
// {"scope": …}, pictures come back as bytes: a document, then columns of numbers. docs/panel.md has both.
const scope = { open: false, signals: [], picture: null, cursors: [null, null], active: 0, place: null, asked: null };
const colours = ["#1663c7", "#c4502b", "#2c8a4b", "#8a4bb8", "#b07d00", "#00838f", "#c2185b", "#5d6d7e"];
const signals = () => state.signals || [];
const unitOf = (name) => (signals().find(([known]) => known === name)?.[1] || "").split(",")[0];

function scopeNews(news) {
  if (!news.signals) return;
  const names = news.signals.map(([name]) => name), before = $("scope-level-of").value;
  $("scope-add").replaceChildren(new Option("add a signal", ""), ...names.map((name) => new Option(name, name)));
  $("scope-level-of").replaceChildren(...names.map((name) => new Option(name, name)));
  scope.signals = scope.signals.filter((name) => names.includes(name));
  if (!scope.signals.length) scope.signals = ["z_servo_error", "x_servo_error", "spindle_rpm"].filter((name) => names.includes(name));
  if (!scope.signals.length) scope.signals = names.slice(1, 3);
  $("scope-level-of").value = names.includes(before) ? before : scope.signals[0] || "";
  wanted();
}

// What is wanted, told to the server.
function wanted(mode) {
  scope.mode = mode || scope.mode || "roll";
  const x = $("scope-x").value, event = $("scope-trigger").value, across = ["pass", "turn"].includes(x);
  $("scope-level").hidden = event !== "level";
  for (const key of document.querySelectorAll("[data-scope]")) key.classList.toggle("go", key.dataset.scope === scope.mode && !across);
  for (const key of document.querySelectorAll(".over-time")) key.hidden = across;
  chips();
  if (!socket || socket.readyState !== 1) return;
  if (!scope.open || !scope.signals.length) { socket.send('{"scope":null}'); return; }
  const asked = { signals: scope.signals, x, mode: across ? "roll" : scope.mode, span: Number($("scope-span").value), points: Math.max(100, Math.min(1500, Math.round($("scope-canvas").clientWidth))) };
  if (scope.place) Object.assign(asked, { mode: "stand", from: scope.place[0], span: scope.place[1] });
  else if (["normal", "single"].includes(asked.mode)) {
    asked.pre = Number($("scope-pre").value);
    asked.trigger = event === "level" ? { signal: $("scope-level-of").value, level: Number($("scope-at").value), edge: $("scope-edge").value } : { event };
  }
  socket.send(JSON.stringify({ scope: asked }));
}
function chips() {
  $("scope-chips").replaceChildren(...scope.signals.map((name, at) => {
    const key = document.createElement("button");
    key.type = "button";
    key.textContent = `${name} ×`;
    key.title = "leave out " + name;
    key.style.borderLeft = `6px solid ${colours[at]}`;
    key.onclick = () => { scope.signals = scope.signals.filter((other) => other !== name); wanted(); };
    return key;
  }));
}
function scopeTold(told) {
  $("scope-told").textContent = told.why || "";
}

// A picture: four bytes say how long the document is; of each curve come x, then lowest and highest of each signal.
function scopePicture(buffer) {
  const length = new DataView(buffer).getUint32(0, true), head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const numbers = new Float64Array(buffer, 4 + length);
  let at = 0;
  const take = (count) => numbers.subarray(at, (at += count));
  head.curves = head.curves.map(([number, count]) => ({ number, x: take(count), values: head.signals.map(() => [take(count), take(count)]) }));
  scope.picture = head;
  drawScope();
}

const shortly = (value) => (value === null || !isFinite(value) ? "–" : Number(value.toPrecision(6)).toString());
function drawScope() {
  const head = scope.picture, canvas = $("scope-canvas");
  if (!head || !scope.open) return;
  const width = canvas.clientWidth, lane = head.signals.length > 3 ? 80 : 120, height = Math.max(1, head.signals.length) * lane + 18, scale = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = width * scale;
    canvas.height = height * scale;
    canvas.style.height = height + "px";
  }
  const pen = canvas.getContext("2d"), css = getComputedStyle(document.documentElement), colour = (name) => css.getPropertyValue("--" + name);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  const h = (x) => (x - head.from) / head.span * width;
  pen.font = "11px system-ui";
  head.signals.forEach((name, signal) => {
    let low = Infinity, high = -Infinity;
    for (const curve of head.curves) {
      const [lows, highs] = curve.values[signal];
      for (let i = 0; i < lows.length; i++) { if (lows[i] < low) low = lows[i]; if (highs[i] > high) high = highs[i]; }
    }
    const top = signal * lane, room = high > low ? high - low : Math.max(Math.abs(high) * 1e-6, 1e-9);
    const v = (value) => top + lane - 12 - (value - low) / room * (lane - 28);
    pen.strokeStyle = colour("line");
    pen.lineWidth = 1;
    pen.strokeRect(0.5, top + 0.5, width - 1, lane - 4);
    head.curves.forEach((curve, number) => {
      const newest = number === head.curves.length - 1, [lows, highs] = curve.values[signal];
      pen.strokeStyle = colours[scope.signals.indexOf(name)] || colours[0];
      pen.globalAlpha = newest ? 1 : 0.35;
      pen.lineWidth = newest ? 1.4 : 1;
      pen.beginPath();
      for (let i = 0; i < curve.x.length; i++) {
        const x = h(curve.x[i]);
        if (i) pen.lineTo(x, v(lows[i])); else pen.moveTo(x, v(lows[i]));
        if (highs[i] !== lows[i]) pen.lineTo(x, v(highs[i]));
      }
      pen.stroke();
    });
    pen.globalAlpha = 1;
    pen.fillStyle = colour("dim");
    pen.fillText(`${name} ${unitOf(name)}`, 6, top + 13);
    pen.textAlign = "right";
    if (isFinite(low)) { pen.fillText(shortly(high), width - 6, top + 13); if (!head.peaks) pen.fillText(shortly(low), width - 6, top + lane - 8); }
    pen.textAlign = "left";
  });
  const bar = (x, name, text) => {
    if (x < head.from || x > head.from + head.span) return;
    pen.strokeStyle = pen.fillStyle = colour(name);
    pen.setLineDash([5, 3]);
    pen.beginPath(); pen.moveTo(h(x), 0); pen.lineTo(h(x), height - 16); pen.stroke();
    pen.setLineDash([]);
    pen.fillText(text, Math.min(h(x) + 3, width - 14), height - 5);
  };
  if (head.trigger !== null) bar(head.trigger, "hold", "T");
  scope.cursors.forEach((x, at) => x !== null && bar(x, "mark", "AB"[at]));
  pen.fillStyle = colour("dim");
  pen.fillText(`${shortly(head.from)} ${head.x}`, 2, height - 5);
  const end = `${shortly(head.from + head.span)} ${head.x}`;
  pen.fillText(end, width - pen.measureText(end).width - 2, height - 5);
  readScope(head);
}

// What stands at a place: of passes that of the newest, of points with several cycles the middle, with several lines the highest.
function valueAt(head, signal, x) {
  const curve = head.curves[head.curves.length - 1];
  if (x === null || !curve || !curve.x.length) return null;
  let at = 0;
  while (at + 1 < curve.x.length && Math.abs(curve.x[at + 1] - x) <= Math.abs(curve.x[at] - x)) at++;
  return head.peaks ? curve.values[signal][1][at] : (curve.values[signal][0][at] + curve.values[signal][1][at]) / 2;
}
function readScope(head) {
  const [a, b] = scope.cursors, minus = (one, other) => (one === null || other === null ? null : other - one), apart = minus(a, b);
  const rows = [["x, " + head.x, shortly(a), shortly(b), shortly(apart) + (apart && head.x === "s" ? ` (${shortly(1 / Math.abs(apart))} Hz)` : "")]];
  head.signals.forEach((name, signal) => {
    const one = valueAt(head, signal, a), other = valueAt(head, signal, b);
    rows.push([`${name} ${unitOf(name)}`, shortly(one), shortly(other), shortly(minus(one, other))]);
  });
  fill($("scope-read"), rows);
  const numbers = head.curves.map((curve) => curve.number), what = $("scope-x").value;
  const seconds = (head.cycles[1] + 1 - head.cycles[0]) * (state.machine?.cycle_s || 0), spectrum = ["hz", "rev"].includes(what);
  const told = head.waits ? ["waits for the trigger"] : spectrum ? (head.peaks ? [`amplitudes of cycles ${head.cycles[0]} to ${head.cycles[1]} (${shortly(seconds)} s), window of Hann`,
    ...head.peaks.map(([x, high], signal) => `${head.signals[signal]} highest ${shortly(high)} ${unitOf(head.signals[signal])} at ${shortly(x)} ${head.x}`)] :
    [head.missing ? `${head.missing} cycles are missing: no spectrum` : what === "rev" ? "no spectrum: two whole turns on the same way are wanted" : "no spectrum: too few cycles"]) :
    head.x === "s" ? [`cycles ${head.cycles[0]} to ${head.cycles[1]}`, head.missing ? head.missing + " are missing" : "none missing", head.trigger_cycle === null ? "" : "trigger in cycle " + head.trigger_cycle] :
    [numbers.length ? `${what === "pass" ? "passes" : "turns"} ${numbers[0]} to ${numbers[numbers.length - 1]}, the newest bold` : `no whole ${what} is kept`];
  $("scope-state").textContent = told.filter(Boolean).join(" · ");
  $("scope-zoom").disabled = a === null || b === null || a === b || spectrum;
  $("scope-whole").disabled = !scope.place;
  for (const key of document.querySelectorAll("[data-save]")) key.disabled = !head.cycles[1];
}

async function saveScope(kind) {
  const [from, to] = scope.picture.cycles, answer = await fetch(`/api/scope.${kind}?from=${from}&to=${to}`, { headers: { Authorization: "Bearer " + token } });
  if (!answer.ok) return scopeTold({ why: await answer.text() });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = `scope-${from}-${to}.${kind}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  scopeTold({ why: `saved ${link.download}; pitchlock panel opens it again` });
}

function anew() { scope.place = null; scope.cursors = [null, null]; }
$("scope-open").onclick = () => {
  scope.open = !scope.open;
  $("scope-body").hidden = !scope.open;
  $("scope-open").textContent = scope.open ? "Close" : "Open";
  wanted();
};
$("scope-add").onchange = (event) => {
  const name = event.target.value;
  event.target.value = "";
  if (name && !scope.signals.includes(name) && scope.signals.length < 8) scope.signals.push(name);
  wanted();
};
for (const key of document.querySelectorAll("[data-scope]")) key.onclick = () => { anew(); wanted(key.dataset.scope); };
$("scope-span").onchange = () => { anew(); wanted(); };
// A piece of time that is shown keeps its place when its spectrum is wanted.
$("scope-x").onchange = () => { const place = scope.place && scope.picture?.x !== "deg" && !["pass", "turn"].includes($("scope-x").value) ? scope.place : null; anew(); scope.place = place; wanted(); };
for (const id of ["scope-trigger", "scope-pre", "scope-level-of", "scope-at", "scope-edge"]) $(id).onchange = () => wanted();
for (const key of document.querySelectorAll("[data-save]")) key.onclick = () => saveScope(key.dataset.save);
$("scope-canvas").onpointerdown = (event) => {
  const head = scope.picture;
  if (!head) return;
  scope.cursors[scope.active] = head.from + event.offsetX / event.target.clientWidth * head.span;
  scope.active = 1 - scope.active;
  drawScope();
};
$("scope-zoom").onclick = () => {
  const [a, b] = scope.cursors;
  scope.place = [Math.min(a, b), Math.abs(b - a)];
  wanted();
};
$("scope-whole").onclick = () => { anew(); wanted(); };
$("scope-clear").onclick = () => { scope.cursors = [null, null]; scope.active = 0; drawScope(); };
window.addEventListener("resize", () => wanted());
