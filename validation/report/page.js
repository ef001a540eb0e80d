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

  async function unpacked(name) {
    const element = document.getElementById(name);
    const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
    element.remove();
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
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

  async function drawAll() {
    try {
      const script = document.createElement("script");
      script.text = await unpacked("packed-library");
      document.head.append(script);
      known = JSON.parse(await unpacked("packed-figures"));
    } catch (error) {
      for (const plot of plots()) plot.textContent = "This browser is too old to draw the figure; the tables hold its numbers.";
      root.dataset.drawn = "none";
      return;
    }
    for (const plot of plots()) {
      try {
        await draw(plot);
      } catch (error) {
        plot.textContent = "This figure cannot be drawn; the tables hold its numbers.";
        console.error(plot.id, error);
      }
      if (!onPaper) await new Promise((then) => setTimeout(then, 0));
    }
    root.dataset.drawn = "all";
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
  addEventListener("beforeprint", () => { onPaper = true; if (known) redress(); });
  addEventListener("afterprint", () => { onPaper = false; if (known) redress(); });
  drawAll();
})();
