// Draws every figure of the page for the width and the ground it has, and again for paper.
(() => {
  const PAPER_PX = 680;

  const figures = [...document.querySelectorAll('.plot')].map((div) => ({
    div,
    aspect: Number(div.dataset.aspect),
    text: div.parentElement.querySelector('script[type="application/json"]').textContent,
  }));

  const painted = (text) => JSON.parse(text, (_, value) => (typeof value === 'string' && value.length < 40 ? theme.paint(value) : value));

  const repainted = (trace) => (trace.line?.color ? { ...trace, line: { ...trace.line, color: theme.paint(trace.line.color) } } : trace);

  function layout(figure, made, width) {
    const narrow = width < 640;
    const tall = narrow ? Math.max(figure.aspect * 1.7, 0.8) : width === PAPER_PX ? Math.max(figure.aspect * 0.8, 0.42) : figure.aspect;
    const size = narrow ? 11 : 13;
    const [ground, ink, gridcolor, edge] = ['--ground', '--ink', '--grid', '--edge'].map(theme.value);
    const grid = { gridcolor, zerolinecolor: edge, linecolor: edge, tickcolor: edge, ticks: 'outside', automargin: true };
    for (const key of Object.keys(made).filter((key) => /^[xy]axis/.test(key))) {
      made[key] = { ...grid, ...made[key] };
      made[key].title = { ...made[key].title, standoff: 8 };
    }
    const top = made.annotations ? 50 : 30;
    return {
      ...made,
      width,
      height: Math.round(width * tall) + (narrow ? 60 : 40),
      font: { family: 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif', color: ink, size },
      margin: { l: narrow ? 48 : 64, r: 12, t: top, b: 70 },
      legend: { orientation: 'h', x: 0, xanchor: 'left', yref: 'container', y: 0, yanchor: 'bottom' },
      paper_bgcolor: ground,
      plot_bgcolor: ground,
      modebar: { bgcolor: ground, color: edge, activecolor: ink },
      hovermode: 'closest',
      dragmode: narrow ? false : 'zoom',
    };
  }

  const draw = (width) => figures.forEach((figure) => {
    const options = { displaylogo: false, displayModeBar: width < 640 ? false : 'hover', scrollZoom: false, modeBarButtonsToRemove: ['select2d', 'lasso2d'] };
    const plot = painted(figure.text);
    Plotly.react(figure.div, link.shown(plot.data).map(repainted), layout(figure, plot.layout, width), options);
  });
  const onScreen = () => draw(document.querySelector('.plot').clientWidth);

  let waiting;
  window.addEventListener('resize', () => { clearTimeout(waiting); waiting = setTimeout(onScreen, 150); });
  window.addEventListener('theme', onScreen);
  window.addEventListener('beforeprint', () => draw(PAPER_PX));
  window.addEventListener('afterprint', onScreen);
  window.addEventListener('chosen', onScreen);
  onScreen();
  link.begin(figures.map((figure) => JSON.parse(figure.text).data));
  for (const { div } of figures) {
    div.on('plotly_click', ({ points: [point] }) => { const what = link.at(point.data, point.pointNumber); if (what) link.choose(what); });
  }
})();
