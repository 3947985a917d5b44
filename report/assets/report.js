// Draws every figure of the page for the width it has, and again for paper.
(() => {
  const PAPER_PX = 680;
  const font = { family: 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif', color: '#1b2430' };
  const grid = { gridcolor: '#e3e7ec', zerolinecolor: '#9aa3ad', linecolor: '#9aa3ad', ticks: 'outside', automargin: true };

  const figures = [...document.querySelectorAll('.plot')].map((div) => ({
    div,
    aspect: Number(div.dataset.aspect),
    plot: JSON.parse(div.parentElement.querySelector('script[type="application/json"]').textContent),
  }));

  function layout(figure, width) {
    const narrow = width < 640;
    const tall = narrow ? Math.max(figure.aspect * 1.7, 0.8) : width === PAPER_PX ? Math.max(figure.aspect * 0.8, 0.42) : figure.aspect;
    const size = narrow ? 11 : 13;
    const made = JSON.parse(JSON.stringify(figure.plot.layout));
    for (const key of Object.keys(made).filter((key) => /^[xy]axis/.test(key))) {
      made[key] = { ...grid, ...made[key] };
      made[key].title = { ...made[key].title, standoff: 8 };
    }
    const top = made.annotations ? 50 : 30;
    return {
      ...made,
      width,
      height: Math.round(width * tall) + (narrow ? 60 : 40),
      font: { ...font, size },
      margin: { l: narrow ? 48 : 64, r: 12, t: top, b: 70 },
      legend: { orientation: 'h', x: 0, xanchor: 'left', yref: 'container', y: 0, yanchor: 'bottom' },
      paper_bgcolor: '#fff',
      plot_bgcolor: '#fff',
      hovermode: 'closest',
      dragmode: narrow ? false : 'zoom',
    };
  }

  const draw = (width) => figures.forEach((figure) => {
    const options = { displaylogo: false, displayModeBar: width < 640 ? false : 'hover', scrollZoom: false };
    Plotly.react(figure.div, figure.plot.data, layout(figure, width ?? figure.div.clientWidth), options);
  });
  const onScreen = () => draw(document.querySelector('.plot').clientWidth);

  let waiting;
  window.addEventListener('resize', () => { clearTimeout(waiting); waiting = setTimeout(onScreen, 150); });
  window.addEventListener('beforeprint', () => draw(PAPER_PX));
  window.addEventListener('afterprint', onScreen);
  onScreen();
})();
