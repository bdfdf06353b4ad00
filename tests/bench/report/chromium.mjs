// Drives headless Chromium over its debugging pipe (Chrome DevTools Protocol, messages ended by a zero byte), with
// Node's standard library alone.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';

// Nothing but the page itself was asked for, and nobody complains; `script`: a global of the page that lists its errors.
export async function is_quiet(page, script) {
  assert.deepEqual(page.complaints, []);
  if (script) assert.deepEqual(await page.evaluate(`${script}.errors`), []);
  assert.equal(page.requests.filter(url => !/^(data|blob):/.test(url)).length, 1, page.requests.join(' '));
}

export async function open_browser() {
  const profile = fs.mkdtempSync(`${os.tmpdir()}/zwang-chromium-`);
  const child = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu', '--hide-scrollbars', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', `--user-data-dir=${profile}`, '--remote-debugging-pipe'], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
  const waiting = new Map(), listeners = [];
  let last = 0, rest = '';
  child.stdio[4].setEncoding('utf8').on('data', chunk => {
    const parts = (rest + chunk).split('\0');
    rest = parts.pop();
    for (const part of parts) {
      const message = JSON.parse(part);
      if (message.id === undefined) listeners.forEach(listen => listen(message));
      else {
        const {resolve, reject, method} = waiting.get(message.id);
        waiting.delete(message.id);
        message.error ? reject(new Error(`${method}: ${message.error.message}`)) : resolve(message.result);
      }
    }
  });
  child.on('exit', () => waiting.forEach(({reject, method}) => reject(new Error(`Chromium ended during ${method}`))));
  const send = (method, params = {}, sessionId) => new Promise((resolve, reject) => {
    waiting.set(++last, {resolve, reject, method});
    child.stdio[3].write(JSON.stringify({id: last, method, params, sessionId}) + '\0');
  });

  async function open_page(file, {width = 1280, height = 900, dark = false, hash = ''} = {}) {
    const {targetId} = await send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await send('Target.attachToTarget', {targetId, flatten: true});
    const page = (method, params) => send(method, params, sessionId);
    const requests = [], complaints = [];
    let loaded;
    const load = new Promise(resolve => { loaded = resolve; });
    listeners.push(({method, params, sessionId: from}) => {
      if (from !== sessionId) return;
      if (method === 'Network.requestWillBeSent') requests.push(params.request.url);
      if (method === 'Runtime.exceptionThrown') complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === 'Runtime.consoleAPICalled' && ['error', 'warning'].includes(params.type)) complaints.push(params.args.map(a => a.value ?? a.description).join(' '));
      if (method === 'Log.entryAdded' && params.entry.level === 'error') complaints.push(params.entry.text);
      if (method === 'Page.loadEventFired') loaded();
    });
    for (const domain of ['Network', 'Runtime', 'Log', 'Page', 'Performance']) await page(`${domain}.enable`);
    await page('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: width < 600});
    await page('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: dark ? 'dark' : 'light'}]});
    const url = file.startsWith('http:') ? file : `file://${fs.realpathSync(file)}`;
    await page('Page.navigate', {url: `${url}${hash && `#${hash}`}`});
    await load;
    const evaluate = async expression => {
      const {result, exceptionDetails} = await page('Runtime.evaluate', {expression: `(async () => (${expression}))()`, awaitPromise: true, returnByValue: true});
      if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    };
    // The file's name ends in png, webp or jpeg.
    const screenshot = async (file, top = 0, bottom = Infinity) => {
      const {cssContentSize: {height: full}} = await page('Page.getLayoutMetrics');
      const clip = {clip: {x: 0, y: top, width, height: Math.min(full, bottom) - top, scale: 1}, captureBeyondViewport: true};
      const format = file.split('.').at(-1), image = {format, ...format !== 'png' && {quality: 82}};
      fs.writeFileSync(file, Buffer.from((await page('Page.captureScreenshot', {...image, ...clip})).data, 'base64'));
    };
    const mouse = (type, x, y, more = {}) => page('Input.dispatchMouseEvent', {type, x, y, ...more});
    const key = async (name, modifiers = 0) => {
      for (const type of ['keyDown', 'keyUp']) await page('Input.dispatchKeyEvent', {type, key: name, modifiers, ...(name === ' ' && {text: ' '})});
    };
    // CPU seconds of the page's process: what other programs do does not count.
    const cpu_seconds = async () => (await page('Performance.getMetrics')).metrics.find(m => m.name === 'ProcessTime').value;
    const close = () => send('Target.closeTarget', {targetId});
    return {evaluate, screenshot, mouse, key, cpu_seconds, close, requests, complaints};
  }
  async function close() {
    await send('Browser.close').catch(() => {});
    await new Promise(resolve => child.exitCode === null ? child.on('exit', resolve) : resolve());
    fs.rmSync(profile, {recursive: true, force: true, maxRetries: 5});
  }
  return {open_page, close};
}
