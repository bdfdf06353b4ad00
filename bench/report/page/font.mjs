// Text widths for Vega outside a browser, from the font's own tables (OpenType: head, hhea, hmtx, cmap formats 4 and
// 12). Without them Vega guesses from the number of letters and lays charts out too wide.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';

function read_font(file) {
  const bytes = fs.readFileSync(file);
  const u16 = at => bytes.readUInt16BE(at), u32 = at => bytes.readUInt32BE(at);
  const table = {};
  for (let i = 0; i < u16(4); i++) table[bytes.toString('latin1', 12 + 16 * i, 16 + 16 * i)] = u32(20 + 16 * i);
  const units = u16(table.head + 18), long_metrics = u16(table.hhea + 34);
  const width = glyph => u16(table.hmtx + 4 * Math.min(glyph, long_metrics - 1)) / units;

  const subtables = Array.from({length: u16(table.cmap + 2)}, (_, i) => table.cmap + u32(table.cmap + 8 + 8 * i));
  const by_format = format => subtables.find(at => u16(at) === format);
  const groups = by_format(12), segments = by_format(4);
  function glyph(code) {
    if (groups) {
      for (let i = 0, at = groups + 16; i < u32(groups + 12); i++, at += 12)
        if (code >= u32(at) && code <= u32(at + 4)) return u32(at + 8) + code - u32(at);
      return 0;
    }
    const count = u16(segments + 6) / 2;
    for (let i = 0; i < count; i++) {
      const end = segments + 14 + 2 * i, start = end + 2 + 2 * count, delta = start + 2 * count, offset = delta + 2 * count;
      if (code > u16(end)) continue;
      if (code < u16(start)) return 0;
      if (u16(offset) === 0) return (code + u16(delta)) & 0xffff;
      const found = u16(offset + u16(offset) + 2 * (code - u16(start)));
      return found ? (found + u16(delta)) & 0xffff : 0;
    }
    return 0;
  }
  const known = new Map();
  return letter => {
    if (!known.has(letter)) {
      const found = glyph(letter.codePointAt(0));
      known.set(letter, found ? width(found) : 0.6);  // a letter of some other font: about this wide
    }
    return known.get(letter);
  };
}

// Makes Vega measure with the named font, as fontconfig finds it.
export function use_font(vega, family) {
  const load = weight => read_font(execFileSync('fc-match', ['-f', '%{file}', `${family}:weight=${weight}`]).toString());
  const regular = load(80), bold = load(200);
  vega.textMetrics.width = (item, text) => {
    const letter_width = /bold|[6-9]00/.test(item.fontWeight ?? '') ? bold : regular;
    let width = 0;
    for (const letter of String(text ?? '')) width += letter_width(letter);
    width *= item.fontSize ?? 11;
    return item.limit > 0 ? Math.min(width, item.limit) : width;
  };
}
