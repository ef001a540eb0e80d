// A way through a figure without a mouse: a place in it is marked, moved by arrow keys, told in words, and picked by Enter.
(() => {
  const held = (k, count) => Math.min(Math.max(k, 0), count - 1);
  const plain = (text) => text.replace(/<br>/g, " ").replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&");
  const short = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "nothing");

  // Cells of a map, in rows and columns; it begins at the worst.
  function cells(root) {
    const heat = root.calcdata.map((one) => one[0]).find((one) => one.trace.type === "heatmap");
    const { xaxis, yaxis } = root._fullLayout;
    const told = (row, column) => Array.from(heat.trace.customdata[row][column]);
    let worst = [0, 0];
    heat.z.forEach((line, row) => Array.from(line).forEach((one, column) => {
      if (told(row, column)[0] > (told(...worst)[0] || 0)) worst = [row, column];
    }));
    const half = [0.5 * Math.abs(xaxis.c2p(heat.xCenter[1]) - xaxis.c2p(heat.xCenter[0])), 0.5 * Math.abs(yaxis.c2p(1) - yaxis.c2p(0))];
    return {
      size: [heat.yCenter.length, heat.xCenter.length],
      first: worst,
      box: ([row, column]) => {
        const [across, down] = [xaxis._offset + xaxis.c2p(heat.xCenter[column]), yaxis._offset + yaxis.c2p(heat.yCenter[row])];
        return { left: across - half[0], top: down - half[1], width: 2 * half[0], height: 2 * half[1] };
      },
      words: ([row, column]) => {
        const [sigma, frequency] = told(row, column);
        const where = `${plain(String(heat.trace.y[row]))}, ${short(frequency)} Hz`;
        if (heat.trace.meta) return `${where}: ${heat.trace.meta} ${sigma.toFixed(3)}`;
      return Number.isFinite(sigma) ? `${where}: ${sigma.toFixed(1)} σ` : `${where}: nothing checks this`;
      },
      pick: ([row, column]) => {
        const custom = told(row, column);
        return Number.isFinite(custom[0]) ? { x: custom[1], y: heat.trace.y[row], custom } : null;
      },
    };
  }

  // Frequencies of the curves in the upper panel; it begins at `at`.
  function lines(root, at) {
    const { xaxis, yaxis, _size } = root._fullLayout;
    const curves = root._fullData.filter((one) => one.yaxis === "y" && one.hoverinfo !== "skip" && one.legendgroup !== "modes");
    const count = Math.max(0, ...curves.map((one) => one._length));
    const [first] = curves;
    const frequency = (k) => (first.x ? first.x[k] : first.x0 + k * first.dx);
    const unit = (yaxis.title.text.match(/\[(.*)\]/) ?? ["", ""])[1];
    let begin = 0;
    for (let k = 0; k < count && Number.isFinite(at); k += 1) if (Math.abs(frequency(k) - at) < Math.abs(frequency(begin) - at)) begin = k;
    return {
      size: [1, count],
      first: [0, begin],
      box: ([, k]) => ({ left: xaxis._offset + xaxis.c2p(frequency(k)) - 1, top: _size.t, width: 2, height: _size.h }),
      words: ([, k]) => `${short(frequency(k))} Hz: ${curves.map((one) => `${plain(one.name)} ${short(Number(one.y[k]))} ${unit}`).join("; ")}`,
      pick: ([, k]) => ({ x: frequency(k), y: null, custom: [] }),
    };
  }

  const STEPS = {
    ArrowLeft: () => [0, -1],
    ArrowRight: () => [0, 1],
    ArrowUp: () => [-1, 0],
    ArrowDown: () => [1, 0],
    PageUp: () => [0, -10],
    PageDown: () => [0, 10],
    Home: ([, columns]) => [0, -columns],
    End: ([, columns]) => [0, columns],
  };

  class Place {
    // `kind` is cells or lines of the drawn figure `root`; `picked` is told what a click there would tell.
    constructor(root, kind, picked) {
      [this.root, this.kind, this.picked, this.at, this.shown] = [root, kind, picked, null, false];
      this.mark = document.createElement("div");
      this.mark.className = kind === cells ? "place place-cell" : "place place-line";
      this.words = document.createElement("div");
      this.words.className = "place-words";
      this.words.setAttribute("role", "status");
      root.append(this.mark, this.words);
      this.hide();
    }

    // It is where it was last, unless something else was picked since: then at that.
    show(at) {
      this.shown = true;
      if (this.at === null || this.begun !== at) [this.begun, this.at] = [at, this.kind(this.root, at).first];
      this.draw();
    }

    hide() {
      this.shown = false;
      this.mark.hidden = true;
      this.words.textContent = "";
    }

    // Where it stands, in the figure as it is drawn now.
    draw() {
      if (!this.shown) return;
      const of = this.kind(this.root, null);
      if (of.size[1] === 0) return;
      this.at = this.at.map((k, way) => held(k, of.size[way]));
      const box = of.box(this.at);
      const { l, t, w, h } = this.root._fullLayout._size;
      this.mark.hidden = box.left + box.width < l || box.left > l + w || box.top + box.height < t || box.top > t + h; // zoomed away
      Object.assign(this.mark.style, Object.fromEntries(Object.entries(box).map(([side, pixels]) => [side, `${pixels}px`])));
      const said = of.words(this.at);
      if (this.words.textContent !== said) this.words.textContent = said;
      const beside = this.kind === cells ? box.top + box.height + 4 : t + 4;
      const fits = beside + this.words.offsetHeight < this.root.clientHeight;
      this.words.style.top = `${fits ? beside : box.top - this.words.offsetHeight - 4}px`;
      const left = box.left + box.width + 6;
      this.words.style.left = `${left + this.words.offsetWidth < this.root.clientWidth ? left : Math.max(0, box.left - this.words.offsetWidth - 6)}px`;
    }

    key(event, at) {
      if (event.target !== this.root || event.ctrlKey || event.altKey || event.metaKey) return;
      const goes = event.key === "Enter" || event.key === " ";
      if (!goes && !STEPS[event.key]) return;
      event.preventDefault();
      if (!this.shown) this.show(at);
      const of = this.kind(this.root, at);
      if (goes) {
        const found = of.pick(this.at);
        if (found) this.picked(found);
        return;
      }
      const step = STEPS[event.key](of.size);
      this.at = this.at.map((k, way) => held(k + step[way], of.size[way]));
      this.draw();
      this.mark.scrollIntoView({ block: "nearest" });
    }
  }

  window.masslineKeys = { Place, cells, lines };
})();
