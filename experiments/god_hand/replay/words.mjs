// Numbers for people.
const spaced = text => text.replace(/\B(?=(\d{3})+(?!\d))/g, ',');
export const integer = n => spaced(String(Math.round(n)));
export function millimetres(metres) {
  if (metres === 0) return '0 mm';
  if (metres > 0 && metres < 1e-6) return '< 1 µm';
  if (Math.abs(metres) < 1e-5) return `${metres.toExponential(0).replaceAll('-', '−')} m`;
  return `${(1e3 * metres).toFixed(Math.abs(metres) < .00995 ? 2 : 1).replace('-', '−')} mm`;
}
export const milliseconds = seconds => seconds < 1e-3 ? `${(1e6 * seconds).toFixed(0)} µs` : `${(1e3 * seconds).toFixed(seconds < .01 ? 2 : 1)} ms`;
export const tiny = (x, unit) => x === 0 ? `0 ${unit}` : `${x.toExponential(0).replace('e-', 'e−').replace('e+', 'e')} ${unit}`;
export const seconds = s => `${s.toFixed(s < 100 ? 3 : 2)} s`;

export function element(name, properties = {}, ...children) {
  const node = Object.assign(document.createElement(name), properties);
  node.append(...children);
  return node;
}
export const css = color => typeof color === 'number' ? `#${color.toString(16).padStart(6, '0')}` : color;
