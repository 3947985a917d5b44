// Draws the part as heights over a grid, seen from any side: each cell is two triangles, the nearest point wins.
(() => {
  const section = document.querySelector('section.solid');
  const canvas = section.querySelector('canvas');
  const part = JSON.parse(section.querySelector('script[type="application/json"]').textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const words = (text) => new Uint16Array(bytes(text).buffer);
  const [columns, rows] = part.size;
  const z = Float32Array.from(words(part.z), (word) => word * part.span / 65535);
  const tool = bytes(part.tool);
  const deviation = part.deviation ? words(part.deviation) : null;
  const [length, width] = [(columns - 1) * part.cell, (rows - 1) * part.cell];
  // Seen from where the part is lower.
  const rise = z.reduce((sum, height, p) => sum + height * ((p % columns) / (columns - 1) - 0.5), 0) / z.length;
  const START = { yaw: rise > 0.02 * part.span ? 35 : -35, pitch: 38 };
  const VIEWS = { turn: START, top: { yaw: 0, pitch: 90 }, front: { yaw: 0, pitch: 0 }, side: { yaw: -90, pitch: 0 } };
  let view = { ...START };
  let by = deviation ? 'deviation' : 'height';

  // Corners of the picture: the grid, and around it a wall down to the floor.
  const points = columns * rows;
  const around = [];
  for (let i = 0; i < columns - 1; i++) around.push(i);
  for (let j = 0; j < rows - 1; j++) around.push(j * columns + columns - 1);
  for (let i = columns - 1; i > 0; i--) around.push((rows - 1) * columns + i);
  for (let j = rows - 1; j > 0; j--) around.push(j * columns);

  const KINDS = ['--grey', '--blue', '--orange', '--green', '--purple', '--yellow'];
  const hex = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));

  // A palette, and where in it every corner is. Heights lie between two colours, others are one or the next.
  function colours() {
    const grey = hex(theme.value('--stock'));
    const list = theme.list(by === 'deviation' ? '--either-way' : '--amount');
    const table = Array.from({ length: 256 }, (_, i) => theme.mix(list, i / 255));
    const palette = by === 'tool' ? KINDS.map((name) => hex(theme.value(name))) : table;
    const at = {
      height: (p) => 255 * z[p] / part.span,
      tool: (p) => tool[p] ? 1 + (tool[p] - 1) % 5 : palette.length,
      deviation: (p) => deviation[p] ? deviation[p] >> 8 : palette.length,
    }[by];
    return { palette: [...palette, grey], shades: Float32Array.from(z, (_, p) => at(p)), grey: palette.length };
  }

  // Steep cells are walls that the grid has cut into steps: which way the wall looks is taken from around them.
  const STEEP = 1.7, NEAR = 2;
  const wall = (() => {
    const clamp = (value, last) => Math.min(last, Math.max(0, value));
    const mean = (of) => {
      const sums = new Float32Array(points);
      for (let p = 0; p < points; p++) {
        for (let k = -NEAR; k <= NEAR; k++) sums[p] += of(p % columns, Math.floor(p / columns), k);
      }
      return sums;
    };
    const along = mean((i, j, k) => z[j * columns + clamp(i + k, columns - 1)]);
    const soft = mean((i, j, k) => along[clamp(j + k, rows - 1) * columns + i]);
    return (i, j) => {
      const of = (x, y) => soft[clamp(y, rows - 1) * columns + clamp(x, columns - 1)];
      const [a, b] = [of(i - 1, j) - of(i + 1, j), of(i, j - 1) - of(i, j + 1)];
      const norm = Math.hypot(a, b);
      return norm > 0 ? [a / norm, b / norm] : null;
    };
  })();

  function draw(fine) {
    const wide = Math.max(200, canvas.clientWidth);
    const tall = Math.round(Math.min(0.6 * wide, 560));
    const sharp = fine ? Math.max(2, devicePixelRatio) : 1;
    const [w, h] = [Math.round(wide * sharp), Math.round(tall * sharp)];
    Object.assign(canvas, { width: w, height: h });
    canvas.style.height = `${tall}px`;
    const context = canvas.getContext('2d');
    const image = context.createImageData(w, h);
    const out = new Uint32Array(image.data.buffer);
    const near = new Float32Array(w * h).fill(-Infinity);
    const [yaw, pitch] = [view.yaw, view.pitch].map((deg) => deg * Math.PI / 180);
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const across = Math.hypot(length, width);
    const flat = view.yaw % 90 === 0 && view.pitch % 90 === 0;
    const [seenWide, seenTall] = flat
      ? [view.yaw ? width : length, view.pitch ? width : part.span]
      : [across, across * sp + part.span * cp];
    const zoom = 0.88 * Math.min(w / seenWide, h / seenTall);
    const X = new Float32Array(points), Y = new Float32Array(points), D = new Float32Array(points);
    const project = (i, j, height) => {
      const [a, b, c] = [i * part.cell - length / 2, j * part.cell - width / 2, height - part.span / 2];
      const [right, back] = [a * cy - b * sy, a * sy + b * cy];
      return [w / 2 + zoom * right, h / 2 - zoom * (back * sp + c * cp), c * sp - back * cp];
    };
    const seen = (a, b) => [a * cy - b * sy, (a * sy + b * cy) * sp, -(a * sy + b * cy) * cp];
    for (let p = 0; p < points; p++) [X[p], Y[p], D[p]] = project(p % columns, Math.floor(p / columns), z[p]);
    const { palette, shades, grey } = colours();
    const step = by === 'height' ? 1 : 0;
    // Light from above, left and in front of the reader, so that it goes with the view.
    const light = [-0.4, 0.75, 0.53];
    const triangle = (ax, ay, ad, bx, by_, bd, cx, cy_, cd, [as, bs, cs], looks) => {
      const area = (bx - ax) * (cy_ - ay) - (cx - ax) * (by_ - ay);
      if (Math.abs(area) < 1e-6) return;
      const dx = ((bd - ad) * (cy_ - ay) - (cd - ad) * (by_ - ay)) / area;
      const dy = ((cd - ad) * (bx - ax) - (bd - ad) * (cx - ax)) / area;
      const [nx, ny, nz] = looks ?? [-dx * zoom, dy * zoom, 1];
      const norm = Math.hypot(nx, ny, nz);
      const lit = 0.45 + 0.6 * Math.max(0, (light[0] * nx + light[1] * ny + light[2] * nz) / norm);
      const sx = step * ((bs - as) * (cy_ - ay) - (cs - as) * (by_ - ay)) / area;
      const sy_ = step * ((cs - as) * (bx - ax) - (bs - as) * (cx - ax)) / area;
      const packed = (shade) => {
        const [red, green, blue] = palette[shade].map((c) => Math.min(255, c * lit) | 0);
        return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
      };
      const [low, high] = [Math.min(as, bs, cs), Math.max(as, bs, cs)];
      const plain = packed(Math.round(as));
      const even = step === 0 || high - low < 1;
      const y0 = Math.max(0, Math.ceil(Math.min(ay, by_, cy_) - 0.5)), y1 = Math.min(h - 1, Math.floor(Math.max(ay, by_, cy_) + 0.5));
      const x0 = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5)), x1 = Math.min(w - 1, Math.floor(Math.max(ax, bx, cx) + 0.5));
      const slack = -0.02 * Math.abs(area) - 0.5;
      const s = Math.sign(area);
      for (let y = y0; y <= y1; y++) for (let x = x0; x <= x1; x++) {
        if (s * ((bx - ax) * (y - ay) - (by_ - ay) * (x - ax)) < slack) continue;
        if (s * ((cx - bx) * (y - by_) - (cy_ - by_) * (x - bx)) < slack) continue;
        if (s * ((ax - cx) * (y - cy_) - (ay - cy_) * (x - cx)) < slack) continue;
        const depth = ad + dx * (x - ax) + dy * (y - ay), at = y * w + x;
        if (depth <= near[at]) continue;
        near[at] = depth;
        out[at] = even ? plain : packed(Math.round(Math.min(high, Math.max(low, as + sx * (x - ax) + sy_ * (y - ay)))));
      }
    };
    for (let j = 0; j < rows - 1; j++) for (let i = 0; i < columns - 1; i++) {
      const a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
      const [low, high] = [Math.min(z[a], z[b], z[c], z[d]), Math.max(z[a], z[b], z[c], z[d])];
      const side = high - low > STEEP * part.cell ? wall(i, j) : null;
      const looks = side && seen(...side);
      triangle(X[a], Y[a], D[a], X[b], Y[b], D[b], X[c], Y[c], D[c], [shades[a], shades[b], shades[c]], looks);
      triangle(X[d], Y[d], D[d], X[c], Y[c], D[c], X[b], Y[b], D[b], [shades[d], shades[c], shades[b]], looks);
    }
    around.forEach((p, k) => {
      const q = around[(k + 1) % around.length];
      const [pf, qf] = [p, q].map((at) => project(at % columns, Math.floor(at / columns), 0));
      triangle(X[p], Y[p], D[p], X[q], Y[q], D[q], ...pf, [grey, grey, grey]);
      triangle(...qf, ...pf, X[q], Y[q], D[q], [grey, grey, grey]);
    });
    context.putImageData(image, 0, 0);
    axes(context, [cy, sy, cp, sp], sharp, h);
  }

  function axes(context, [cy, sy, cp, sp], sharp, h) {
    const arm = 34 * sharp, [x0, y0] = [48 * sharp, h - 48 * sharp];
    context.strokeStyle = context.fillStyle = theme.value('--ink');
    context.font = `${12 * sharp}px system-ui, sans-serif`;
    context.lineWidth = 1.5 * sharp;
    for (const [name, dx, dy] of [['X', cy, -sy * sp], ['Y', -sy, -cy * sp], ['Z', 0, -cp]]) {
      if (Math.hypot(dx, dy) < 0.05) continue;
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x0 + arm * dx, y0 + arm * dy);
      context.stroke();
      context.fillText(name, x0 + 1.25 * arm * dx - 4 * sharp, y0 + 1.25 * arm * dy + 4 * sharp);
    }
  }

  function key() {
    const scale = section.querySelector('.scale');
    if (by === 'tool') {
      const one = (number, i) => `<span><i style="background: var(${KINDS[1 + i % 5]})"></i>tool ${number}</span>`;
      scale.innerHTML = part.tools.map(one).join('');
      return;
    }
    const [list, ends] = by === 'height'
      ? ['--amount', ['0', `${part.span.toFixed(2)} mm above the floor`]]
      : ['--either-way', [`−${part.reach.toFixed(2)} µm: too deep`, `+${part.reach.toFixed(2)} µm: stands off`]];
    scale.innerHTML = `<span>${ends[0]}</span><b style="background: linear-gradient(90deg, var(${list}))"></b><span>${ends[1]}</span>`;
  }

  let waiting;
  const again = () => { draw(false); clearTimeout(waiting); waiting = setTimeout(() => draw(true), 120); };
  const turn = (yaw, pitch) => {
    view = { yaw: (view.yaw + yaw) % 360, pitch: Math.min(90, Math.max(0, view.pitch + pitch)) };
    again();
  };

  const views = section.querySelector('.views');
  for (const [name, of] of Object.entries(VIEWS)) {
    const button = document.createElement('button');
    button.textContent = name === 'turn' ? 'reset' : name;
    button.addEventListener('click', () => { view = { ...of }; draw(true); });
    views.append(button);
  }
  const choice = document.createElement('select');
  choice.setAttribute('aria-label', 'Coloured by');
  for (const name of ['height', 'tool', ...(deviation ? ['deviation'] : [])]) choice.add(new Option(`by ${name}`, name, false, name === by));
  choice.addEventListener('change', () => { by = choice.value; key(); draw(true); });
  views.append(choice);

  canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener('pointermove', (event) => {
    if (event.buttons) turn(-event.movementX * 0.5, event.movementY * 0.5);
  });
  canvas.addEventListener('keydown', (event) => {
    const by = { ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] }[event.key];
    if (!by) return;
    event.preventDefault();
    turn(...by);
  });
  for (const event of ['theme', 'resize', 'beforeprint', 'afterprint']) window.addEventListener(event, () => draw(true));
  key();
  draw(true);
})();
