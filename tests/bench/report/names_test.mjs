// node names_test.mjs PROGRAM [REPORT...]: names on the pages of real runs, in every class of problems, wide and narrow, light and
// dark. Of these pages; none: of the suites quick and standard, the latter without repetitions.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import {open_browser} from './chromium.mjs';
import {misplaced_names} from './names.mjs';

const [program, ...given] = process.argv.slice(2);
const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-names-`);
const page_of = (suite, ...words) => {
  execFileSync(program, ['bench', '--suite', suite, '--out', `${folder}/${suite}`, ...words], {stdio: 'ignore'});
  return `${folder}/${suite}/report.html`;
};
const browser = await open_browser();
try {
  for (const file of given.length ? given : [page_of('quick'), page_of('standard', '--accuracy')])
    for (const [width, dark] of [[1280, false], [1280, true], [400, false], [400, true]]) {
      const page = await browser.open_page(file, {width, height: 1000, dark});
      const picker = `document.querySelector('select[data-state=problem_class]')`;
      const classes = await page.evaluate(`[...${picker}?.options ?? []].map(option => option.textContent)`);
      let named = 0;
      for (const [k, name] of (classes.length ? classes : ['']).entries()) {
        if (name) await page.evaluate(`(${picker}.value = '${k}', ${picker}.onchange())`);
        await page.evaluate('zwang_page.draw_all()');
        named += await page.evaluate(`zwang_page.views['work-precision'].data('rows').filter(row => row.part === 'label').length`);
        assert.deepEqual(await misplaced_names(page), [], `${file}, ${name} at ${width} px`);
      }
      assert.ok(named >= 3, `${file} has names: ${named}`);
      await page.close();
    }
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}
