// From a line of the program to its curves and back: what is chosen stands out in the pictures, in the tables and in
// the program; a bar says what it is. A choice is a line, or one pass of a line that makes several.
const link = (() => {
  const FAINT = 0.12;
  const rows = [...document.querySelectorAll('[data-line]')];
  let chosen = null;

  const numbers = (column) => (Array.isArray(column) ? column
    : new Float32Array(Uint8Array.from(atob(column.bdata), (c) => c.charCodeAt(0)).buffer));

  // A trace of points with their lines, as runs: of one line alone, the rest left out.
  function only(trace, line) {
    const [x, y] = [numbers(trace.x), numbers(trace.y)];
    const runs = trace.meta.lines;
    const points = { x: [], y: [] };
    for (let run = 0; run < runs.length; run += 2) {
      if (runs[run + 1] !== line) continue;
      for (let i = runs[run]; i <= Math.min(runs[run + 2] ?? x.length, x.length - 1); i++) { points.x.push(x[i]); points.y.push(y[i]); }
      points.x.push(null);
      points.y.push(null);
    }
    return { ...trace, ...points, meta: undefined, showlegend: false, hoverinfo: 'skip', line: { ...trace.line, color: 'var(--ink)', dash: 'solid', width: 4 } };
  }

  const is = (meta) => (chosen.pass === undefined ? meta.line === chosen.line : meta.pass === chosen.pass);

  // The traces of a picture with what is chosen.
  function shown(traces) {
    if (!chosen) return traces;
    const marked = traces.map((trace) => (trace.meta?.line === undefined || is(trace.meta) ? trace : { ...trace, opacity: FAINT }));
    return marked.concat(traces.filter((trace) => trace.meta?.lines?.includes(chosen.line)).map((trace) => only(trace, chosen.line)));
  }

  // What a point of a curve belongs to.
  function at(trace, number) {
    if (trace.meta?.line !== undefined) return { line: trace.meta.line, pass: trace.meta.pass };
    const runs = trace.meta?.lines ?? [];
    let line;
    for (let run = 0; run < runs.length && runs[run] <= number; run += 2) line = runs[run + 1];
    return line === undefined ? null : { line };
  }

  const bar = document.createElement('div');
  bar.className = 'chosen-bar';
  bar.setAttribute('role', 'status');
  bar.hidden = true;
  document.querySelector('main').append(bar);

  function tell() {
    bar.hidden = !chosen;
    bar.replaceChildren();
    if (!chosen) return;
    const line = document.querySelector(`.program [data-line="${chosen.line}"]`);
    const button = (text, act) => { const made = document.createElement('button'); made.textContent = text; made.addEventListener('click', act); return made; };
    const code = document.createElement('code');
    code.textContent = line?.textContent.trim() ?? '';
    bar.append(`Line ${chosen.line}${chosen.pass === undefined ? '' : `, pass ${chosen.pass + 1}`} `, code);
    if (line) bar.append(button('program', () => line.scrollIntoView({ block: 'center' })));
    const row = rows.find((one) => one.dataset.pass !== undefined && is({ line: Number(one.dataset.line), pass: Number(one.dataset.pass) }));
    if (row) bar.append(button('table', () => row.scrollIntoView({ block: 'center' })));
    bar.append(button('all', () => choose(null)));
  }

  function choose(what) {
    const same = what && chosen && what.line === chosen.line && what.pass === chosen.pass;
    chosen = same ? null : what;
    for (const row of rows) {
      const meta = { line: Number(row.dataset.line), pass: row.dataset.pass === undefined ? undefined : Number(row.dataset.pass) };
      row.classList.toggle('chosen', Boolean(chosen) && (meta.pass === undefined ? meta.line === chosen.line : is(meta)));
    }
    tell();
    window.dispatchEvent(new Event('chosen'));
  }

  // Rows and lines that some curve belongs to can be chosen, by hand or by keyboard.
  function begin(figures) {
    const known = new Set(figures.flatMap((traces) => traces.flatMap(({ meta }) => (meta?.line === undefined ? (meta?.lines ?? []).filter((_, i) => i % 2) : [meta.line]))));
    for (const row of rows.filter((one) => known.has(Number(one.dataset.line)))) {
      const act = () => choose({ line: Number(row.dataset.line), pass: row.dataset.pass === undefined ? undefined : Number(row.dataset.pass) });
      row.classList.add('leads');
      row.tabIndex = 0;
      row.title = 'Show its curves';
      row.addEventListener('click', act);
      row.addEventListener('keydown', (event) => { if (event.key === 'Enter' && event.target === row) act(); });
    }
    document.addEventListener('keydown', (event) => { if (event.key === 'Escape' && chosen) choose(null); });
  }

  return { shown, at, choose, begin };
})();
