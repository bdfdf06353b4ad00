// node page_test.mjs PAGE [PNG]: the engines' page, driven in headless Chromium; engines_test.py makes one.
import assert from 'node:assert/strict';
import {is_quiet, open_browser} from '../report/chromium.mjs';

const [file, png] = process.argv.slice(2);
const browser = await open_browser();
try {
  for (const [width, dark] of [[1280, false], [1280, true], [400, false], [400, true]]) {
    const page = await browser.open_page(file, {width, dark});
    await page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true; })");
    assert.ok(await page.evaluate('document.documentElement.scrollWidth') <= width, `wider than ${width} px`);
    const shown = () => page.evaluate("[...document.querySelectorAll('.map td > span')].filter(s => s.offsetParent).map(s => s.title)");
    const choose = (id, value) => page.evaluate(`(() => { const s = document.getElementById('${id}'); s.value = '${value}'; s.dispatchEvent(new Event('change')); })()`);
    const before = await shown();
    await choose('step', 0);
    const after = await shown();
    assert.equal(after.length, before.length);
    assert.notDeepEqual(after, before);
    await choose('setting', 'tuned');
    assert.equal((await shown()).length, before.length / 2);
    const ground = () => page.evaluate('getComputedStyle(document.body).backgroundColor'), first = await ground();
    await page.evaluate("document.getElementById('theme').click()");
    assert.notEqual(await ground(), first);
    await page.evaluate("document.getElementById('theme').click()");
    for (const svg of await page.evaluate("[...document.querySelectorAll('section svg')].map(s => s.outerHTML)")) assert.ok(!/NaN|undefined|Infinity/.test(svg), svg);
    if (png) await page.screenshot(png.replace('.png', `-${width}-${dark ? 'dark' : 'light'}.png`));
    await is_quiet(page);
    await page.close();
  }
} finally {
  await browser.close();
}
