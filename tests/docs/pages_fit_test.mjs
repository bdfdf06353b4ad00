// node pages_fit_test.mjs SITE [FOLDER]: every page of the built site at 1280 and 400 px in headless Chromium. Nothing reaches
// beyond the right edge, pictures are there, nobody complains. With a FOLDER each page is left there as a picture, to be looked at.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import {open_browser} from '../bench/report/chromium.mjs';

const [site, pictures] = process.argv.slice(2);
const pages = fs.readdirSync(site, {recursive: true}).filter(name => name.endsWith('.html') && !name.startsWith('api/') && name !== '404.html').sort();
assert.ok(pages.length > 30, `${pages.length} pages`);

// What lies beyond the right edge, and is not in a box of its own that scrolls (tables, code) or that hides it (the folded menus).
const beyond = width => `(() => {
  const edge = ${width + 1};
  const inside = e => e && e !== document.body && (getComputedStyle(e).overflowX !== 'visible' || inside(e.parentElement));
  const said = [...document.querySelectorAll('.md-content *, .md-footer *')]
    .filter(e => e.getClientRects().length && e.getBoundingClientRect().right > edge && !inside(e.parentElement) && !inside(e))
    .map(e => e.tagName + ' ' + e.textContent.trim().slice(0, 60));
  return document.documentElement.scrollWidth > edge ? ['the page scrolls sideways', ...said] : said;
})()`;
const broken = `[...document.images].filter(i => !i.naturalWidth).map(i => i.src)`;

const browser = await open_browser();
const faults = [];
try {
  for (const name of pages)
    for (const width of [1280, 400]) {
      const page = await browser.open_page(path.join(site, name), {width});
      await page.evaluate('Promise.all([...document.images].map(i => i.decode().catch(() => {})))');
      for (const what of [...await page.evaluate(beyond(width)), ...await page.evaluate(broken), ...page.complaints])
        faults.push(`${name} at ${width} px: ${what}`);
      if (pictures) await page.screenshot(path.join(pictures, `${name.replace(/\W/g, '_')}_${width}.png`));
      await page.close();
    }
} finally {
  await browser.close();
}
assert.deepEqual(faults, []);
console.log(`${pages.length} pages fit`);
