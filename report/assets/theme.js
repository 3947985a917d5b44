// Light or dark, as the system likes it or as the reader chooses, which is remembered where the browser allows it.
// Others may ask `theme.paint` for the colours of this moment, and hear by the event `theme` that they have changed.
const theme = (() => {
  const KEY = 'pitchlock-theme';
  const dark = document.getElementById('dark');
  const auto = dark.media;
  const changed = () => window.dispatchEvent(new Event('theme'));
  let chosen = 'auto';
  try { chosen = localStorage.getItem(KEY) ?? 'auto'; } catch { /* A page from a file may have no storage. */ }

  const apply = () => { dark.media = { light: 'not all', dark: 'screen' }[chosen] ?? auto; };
  apply();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);

  document.addEventListener('DOMContentLoaded', () => {
    const label = document.createElement('label');
    label.className = 'theme';
    label.textContent = 'Colours ';
    const select = document.createElement('select');
    for (const name of ['auto', 'light', 'dark']) select.add(new Option(name, name, false, name === chosen));
    label.append(select);
    document.querySelector('main').prepend(label);
    select.addEventListener('change', () => {
      chosen = select.value;
      try { localStorage.setItem(KEY, chosen); } catch { /* Then it holds until the page is closed. */ }
      apply();
      changed();
    });
  });

  const value = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const list = (name) => value(name).split(',').map((color) => color.trim());
  const channels = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));

  // The colour at a place between 0 and 1 of a list, as [red, green, blue].
  const mix = (colors, place) => {
    const at = Math.min(Math.max(place, 0), 1) * (colors.length - 1);
    const low = Math.min(Math.floor(at), colors.length - 2);
    const [from, to] = [channels(colors[low]), channels(colors[low + 1])];
    return from.map((channel, i) => Math.round(channel + (at - low) * (to[i] - channel)));
  };

  // What is written for a colour in a picture, for the ground of this moment.
  const paint = (written) => {
    const [, kind, name, place] = /^(var|mix|scale)\((--[\w-]+)(?: ([\d.]+))?\)$/.exec(written) ?? [];
    if (kind === 'var') return value(name);
    if (kind === 'mix') return `rgb(${mix(list(name), Number(place))})`;
    if (kind === 'scale') return list(name).map((color, i, all) => [i / (all.length - 1), color]);
    return written;
  };

  // Paper is light, whatever the screen is; what draws hears of it after this.
  window.addEventListener('beforeprint', () => { dark.media = 'not all'; });
  window.addEventListener('afterprint', apply);
  return { paint, value, list, mix };
})();
