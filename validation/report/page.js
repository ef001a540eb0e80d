"use strict";
(() => {
  const root = document.documentElement;
  const PAPER_WIDTH = 799; // CSS pixels between the margins of A4, as the style sheet shrinks figures in print: letters of 11 are 7 pt
  const PAPER_HEIGHT = 0.78; // of a figure's height on the screen
  const PAPER_TALLEST = 610; // CSS pixels: little more than half a page with its heading; a taller figure leaves half of one empty
  const PAPER_LETTERS = 11; // CSS pixels of an axis title, which stands beside half as much of an axis
  const settings = { responsive: true }; // buttons and all else that must hold on every page comes with the library
  const plots = () => [...document.querySelectorAll(".plot")];
  let known = null;
  let onPaper = location.hash === "#paper";

  function unpacked(name) {
    const element = document.getElementById(name);
    const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
    element.remove();
    return new TextDecoder().decode(inflated(bytes));
  }

  // What gzip has packed (RFC 1951, 1952), at once: a page may be printed before a DecompressionStream has said anything.
  function inflated(bytes) {
    const out = new Uint8Array(new DataView(bytes.buffer).getUint32(bytes.length - 4, true));
    let [from, to, held, count] = [10, 0, 0, 0]; // behind the head of gzip, as Python writes it: no name, no comment

    function bits(wanted) {
      for (; count < wanted; count += 8) held |= bytes[from++] << count;
      const value = held & ((1 << wanted) - 1);
      held >>>= wanted;
      count -= wanted;
      return value;
    }

    // A canonical Huffman code by the lengths of its words: how many there are of each length, and symbols in their order.
    function code(lengths) {
      const counts = new Uint16Array(16);
      for (const length of lengths) counts[length]++;
      counts[0] = 0;
      const starts = counts.map((_, n) => counts.subarray(0, n).reduce((sum, one) => sum + one, 0));
      const symbols = new Uint16Array(lengths.length);
      lengths.forEach((length, symbol) => { if (length) symbols[starts[length]++] = symbol; });
      return { counts, symbols };
    }

    function symbol({ counts, symbols }) {
      for (let [n, word, first, index] = [1, 0, 0, 0]; n < 16; n++) {
        word = (word << 1) | bits(1);
        if (word - first < counts[n]) return symbols[index + word - first];
        index += counts[n];
        first = (first + counts[n]) << 1;
      }
      throw new Error("the page is damaged");
    }

    const many = (length, times) => Array(times).fill(length);
    const LENGTHS = [...many(8, 144), ...many(9, 112), ...many(7, 24), ...many(8, 8)];
    const ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

    function codes(kind) {
      if (kind === 1) return [code(LENGTHS), code(many(5, 30))];
      const [literals, distances, known] = [bits(5) + 257, bits(5) + 1, bits(4) + 4];
      const first = many(0, 19);
      for (let k = 0; k < known; k++) first[ORDER[k]] = bits(3);
      const [of, lengths] = [code(first), []];
      while (lengths.length < literals + distances) {
        const one = symbol(of);
        if (one < 16) lengths.push(one);
        else if (one === 16) lengths.push(...many(lengths.at(-1), 3 + bits(2)));
        else lengths.push(...many(0, one === 17 ? 3 + bits(3) : 11 + bits(7)));
      }
      return [code(lengths.slice(0, literals)), code(lengths.slice(literals))];
    }

    for (let last = 0; !last;) {
      last = bits(1);
      const kind = bits(2);
      if (kind === 0) {
        [held, count] = [0, 0];
        const length = bytes[from] | (bytes[from + 1] << 8);
        out.set(bytes.subarray(from + 4, from + 4 + length), to);
        [from, to] = [from + 4 + length, to + length];
        continue;
      }
      const [literals, distances] = codes(kind);
      for (let one = symbol(literals); one !== 256; one = symbol(literals)) {
        if (one < 256) { out[to++] = one; continue; }
        const step = one < 265 || one === 285 ? 0 : (one - 261) >> 2;
        const length = one === 285 ? 258 : one < 265 ? one - 254 : (((one - 265) & 3) + 4 << step) + 3 + bits(step);
        const far = symbol(distances);
        const wide = far < 4 ? 0 : (far - 2) >> 1;
        const back = far < 4 ? far + 1 : ((far & 1) + 2 << wide) + 1 + bits(wide);
        for (const end = to + length; to < end; to++) out[to] = out[to - back];
      }
    }
    return out;
  }

  function dark() {
    if (onPaper) return false;
    const chosen = root.dataset.theme;
    return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  }

  function template() {
    const own = known.templates[dark() ? "dark" : "light"];
    if (!onPaper) return own;
    const small = (axis) => ({ ...axis, title: { ...axis?.title, font: { size: PAPER_LETTERS } } });
    return { ...own, layout: { ...own.layout, xaxis: small(own.layout?.xaxis), yaxis: small(own.layout?.yaxis) } };
  }

  function layout(figure) {
    const own = { ...figure.layout, template: template() };
    if (!onPaper) return own;
    return { ...own, width: PAPER_WIDTH, height: onSheet(own.height), yaxis: { ...own.yaxis, tickvals: named(own) } };
  }

  // Rows of a map that bear their names: all of them, or on paper every second and so on where they are narrower than letters.
  function named(own) {
    const rows = own.yaxis?.tickvals;
    if (!onPaper || own.yaxis?.type !== "category") return rows;
    const room = onSheet(own.height) - own.margin.t - own.margin.b;
    const step = Math.ceil((PAPER_LETTERS * rows.length) / room);
    return rows.filter((_, k) => k % step === 0);
  }

  const onSheet = (height) => Math.min(PAPER_HEIGHT * height, PAPER_TALLEST);

  function shown(plot) {
    const group = plot.dataset.group;
    return known.figures[group ? `${group}/${plot.dataset.shown}` : plot.id];
  }

  function draw(plot) {
    const figure = shown(plot);
    plot.setAttribute("aria-label", figure.layout.title.text.replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&"));
    return Plotly.react(plot, figure.data, layout(figure), settings);
  }

  // What a theme and a sheet of paper change of a figure that is there; what the reader zoomed into stays.
  function redress() {
    for (const plot of plots().filter((one) => one.layout)) {
      const own = shown(plot).layout;
      const [width, height] = onPaper ? [PAPER_WIDTH, onSheet(own.height)] : [null, own.height];
      const rows = own.yaxis?.tickvals ? { "yaxis.tickvals": named(own) } : {};
      Plotly.relayout(plot, { template: template(), width, height, ...rows });
      if (!onPaper) Plotly.Plots.resize(plot);
    }
  }

  function readAll() {
    try {
      const script = document.createElement("script");
      script.text = unpacked("packed-library");
      document.head.append(script);
      known = JSON.parse(unpacked("packed-figures"));
    } catch (error) {
      console.error(error); // every figure says that it cannot be drawn
    }
  }

  function drawn(plot) {
    const failed = (error) => {
      plot.textContent = "This figure cannot be drawn; the tables hold its numbers.";
      console.error(plot.id, error);
    };
    try {
      return draw(plot).catch(failed);
    } catch (error) {
      failed(error);
    }
  }

  async function drawAll() {
    await new Promise((then) => setTimeout(then, 0)); // texts and tables are there first
    if (!known) readAll();
    for (const plot of plots()) {
      if (!plot.layout) {
        const done = drawn(plot);
        if (!onPaper) await done;
      }
      if (!onPaper) await new Promise((then) => setTimeout(then, 0));
    }
    root.dataset.drawn = known ? "all" : "none";
  }

  // Whoever prints before all is drawn gets the rest at once: a browser waits for nothing that is promised.
  function onSheets() {
    onPaper = true;
    if (!known) readAll();
    for (const plot of plots().filter((one) => !one.layout)) drawn(plot);
    redress();
  }

  function chosen(group) {
    const part = (name) => document.querySelector(`select[data-choice="${group}"][data-part="${name}"]`);
    return part("run") ? part("run").value : `${part("load").value}-${part("motion").value}`;
  }

  for (const select of document.querySelectorAll("select[data-choice]")) {
    select.addEventListener("change", () => {
      const group = select.dataset.choice;
      const plot = document.querySelector(`.plot[data-group="${group}"]`);
      plot.dataset.shown = chosen(group);
      if (known) draw(plot);
    });
  }

  const told = document.getElementById("told");
  function tell(words) {
    told.textContent = words;
    told.classList.add("seen");
    setTimeout(() => told.classList.remove("seen"), 1800);
  }

  // Tab-separated values: a number with all its digits, a text on one line, which no spreadsheet takes for a formula.
  function separated(table) {
    const words = (one) => one.innerText.replace(/\s+/g, " ").trim().replace(/^[=+@-]/, "'$&");
    const cell = (one) => one.dataset.value ?? words(one);
    return [...table.rows].map((row) => [...row.cells].map(cell).join("\t")).join("\n");
  }

  async function copied(text) {
    if (navigator.clipboard && window.isSecureContext) return navigator.clipboard.writeText(text);
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) throw new Error("copying was refused");
  }

  for (const button of document.querySelectorAll("button.copy")) {
    button.addEventListener("click", async () => {
      try {
        await copied(separated(button.closest("table")));
        tell("The table is copied: paste it into a spreadsheet.");
      } catch (error) {
        tell("The browser refused to copy: mark the table and copy it.");
      }
      button.focus();
    });
  }

  const switched = document.getElementById("theme");
  switched.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    switched.setAttribute("aria-pressed", String(dark()));
    if (known) redress();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => known && redress());
  document.getElementById("print").addEventListener("click", () => print());
  addEventListener("beforeprint", onSheets);
  addEventListener("afterprint", () => { onPaper = false; if (known) redress(); });
  drawAll();
})();
