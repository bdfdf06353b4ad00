// No name covers a marker, each is nearer to its own solver's markers and line than to any other's (1 px: ends that are nearer to
// each other than lines of text share a column), and who has no name in the chart stands in the key below it.
const charts_with_names = {
  'work-precision': ['x', 'time', 'tolerance', -1], 'profile': ['at', 'share', 'at', 1], 'data-profile': ['at', 'share', 'at', 1],
  'convergence-iteration': ['x', 'y', 'x', 1], 'convergence-time': ['x', 'y', 'x', 1], 'scaling': ['size', 'time', 'size', 1],
};
const misplaced = (name, [x, y, order, sign]) => `(() => {
  const view = zwang_page.views['${name}'];
  if (!view) return [];
  const [across, up] = ['x', 'y'].map(axis => view.scale(axis));
  const rows = view.data('rows'), pixel = row => ({x: across(row['${x}']), y: up(row['${y}'])});
  const points = rows.filter(row => row.part !== 'label' && row.part !== 'fit' && row.drawn !== 'recorded');
  const solvers = [...new Set(points.map(row => row.solver))], named = rows.filter(row => row.part === 'label');
  const lines = Object.fromEntries(solvers.map(solver => {
    const own = points.filter(row => row.solver === solver), line = own.map(pixel);
    const joined = own.filter(row => '${name}' !== 'work-precision' || row.drawn === 'ok').sort((a, b) => ${sign} * (a['${order}'] - b['${order}'])).map(pixel);
    joined.forEach((to, i) => {
      if (i === 0) return;
      const corners = '${name}'.endsWith('profile') ? [joined[i - 1], {x: to.x, y: joined[i - 1].y}, to] : [joined[i - 1], to];
      for (let k = 1; k < corners.length; ++k)
        for (let s = 0; s < 1; s += .01) line.push({x: corners[k - 1].x + s * (corners[k].x - corners[k - 1].x), y: corners[k - 1].y + s * (corners[k].y - corners[k - 1].y)});
    });
    return [solver, line];
  }));
  const key = [...document.querySelectorAll('[data-chart="${name}"] .key span')].map(span => span.textContent.trim());
  const nameless = solvers.filter(solver => named.some(label => label.solver === solver) === key.includes(solver)).map(solver => solver + ' is named twice or not at all');
  return [...nameless, ...named.flatMap(label => {
    const at = pixel(label), near = at.x + label.shift, far = near + Math.sign(label.shift) * 6 * label.text.length;
    const off = p => Math.hypot(Math.max(Math.min(near, far) - p.x, 0, p.x - Math.max(near, far)), Math.max(at.y - 6.5 - p.y, 0, p.y - at.y - 6.5));
    const nearest = solver => Math.min(...lines[solver].map(off)), own = nearest(label.solver), others = Math.min(...solvers.filter(s => s !== label.solver).map(nearest));
    return [...Math.min(...points.map(row => off(pixel(row)))) < 3 ? [label.text + ' covers a marker'] : [], ...others + 1 < own ? [label.text + ' is nearer to another'] : []];
  })];
})()`;

// Of all charts that the page shows: "chart: what is wrong".
export async function misplaced_names(page) {
  const wrong = [];
  for (const [name, axes] of Object.entries(charts_with_names)) wrong.push(...(await page.evaluate(misplaced(name, axes))).map(what => `${name}: ${what}`));
  return wrong;
}
