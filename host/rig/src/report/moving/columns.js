"use strict";
// Numbers of the page, read from its inert scripts.
const Columns = (() => {
  async function inflated(id) {
    const text = atob(document.getElementById(id).textContent.trim());
    const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // A column: four planes of bytes, each difference with its sign in the lowest bit.
  function column(bytes, start, rows, step) {
    const values = new Float64Array(rows);
    let units = 0;
    for (let row = 0; row < rows; row++) {
      const at = start + row;
      const bits = bytes[at] | bytes[at + rows] << 8 | bytes[at + 2 * rows] << 16 | bytes[at + 3 * rows] << 24;
      units = (units + (bits >>> 1 ^ -(bits & 1))) | 0;
      values[row] = units === -0x80000000 ? NaN : units * step;
    }
    return values;
  }

  // The tables by name, each with its columns by name.
  async function tables(id, described) {
    const bytes = await inflated(id);
    const found = {};
    let start = 0;
    for (const [name, { rows, columns }] of described) {
      found[name] = { rows };
      for (const { name: column_name, step } of columns) {
        found[name][column_name] = column(bytes, start, rows, step);
        start += 4 * rows;
      }
    }
    return found;
  }

  // The last row that is not after a time; the first one before all rows.
  function row_at(times, time) {
    let [low, high] = [0, times.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time + 1e-9) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Least and greatest value of each of some intervals of rows; all rows where there are few. Gaps are null.
  function thinned(times, values, from, to, intervals) {
    const [x, y] = [[], []];
    if (!times.length) return { x, y };
    const [first, last] = [row_at(times, from), Math.min(times.length - 1, row_at(times, to) + 1)];
    const push = (row) => { x.push(times[row]); y.push(Number.isFinite(values[row]) ? values[row] : null); };
    const count = last - first + 1;
    if (count <= 2 * intervals) {
      for (let row = first; row <= last; row++) push(row);
      return { x, y };
    }
    push(first);
    for (let interval = 0; interval < intervals; interval++) {
      const end = first + Math.floor(count * (interval + 1) / intervals);
      let [least, greatest, gap] = [-1, -1, -1];
      for (let row = first + Math.floor(count * interval / intervals); row < end; row++) {
        if (!Number.isFinite(values[row])) { gap = row; continue; }
        if (least < 0 || values[row] < values[least]) least = row;
        if (greatest < 0 || values[row] > values[greatest]) greatest = row;
      }
      [...new Set([least, greatest, gap])].filter((row) => row >= 0).sort((a, b) => a - b).forEach(push);
    }
    push(last);
    return { x, y };
  }

  return { inflated, tables, row_at, thinned };
})();
