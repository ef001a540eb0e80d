// What the page needs beyond its widgets: figures, the view in three dimensions, dropped folders, and the system's dark or light.
// Everything is asked of this address; nothing that a file says becomes a part of a template.
(() => {
  const { h, ref } = window.Vue;

  let plotly = null;
  function library() {
    plotly ??= new Promise((done, failed) => {
      const script = document.createElement("script");
      script.src = "plotly.js";
      script.onload = () => done(window.Plotly);
      script.onerror = () => failed(new Error("plotly.js cannot be loaded"));
      document.head.append(script);
    });
    return plotly;
  }

  const axis = (id) => `${id[0]}axis${id.slice(1)}`;

  // The path of a curve in the pixels of its axes; it is broken where it has no place, as at zero of a logarithm.
  function way(x, y, across, up) {
    let [path, pen] = ["", "M"];
    x.forEach((at, k) => {
      const [right, down] = [across.c2p(across.d2c(at)), up.c2p(up.d2c(y[k]))];
      if (!Number.isFinite(right) || !Number.isFinite(down)) {
        pen = "M";
        return;
      }
      path += `${pen}${right.toFixed(1)},${Math.max(-9999, Math.min(9999, down)).toFixed(1)}`;
      pen = "L";
    });
    return path || "M0,0";
  }

  // The numbers of a figure as CSV: curves that share their lines side by side, blocks of others below them; of a map its cells.
  const cell = (value) => (typeof value === "number" ? (Number.isFinite(value) ? String(value) : "") : `"${plain(String(value)).replaceAll('"', '""')}"`);
  const plain = (text) => text.replace(/<br>/g, " ").replace(/<[^>]*>/g, "").replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&");

  function table(root) {
    const blocks = new Map();
    root.calcdata.forEach((points) => {
      const { trace } = points[0];
      const [across, up] = [root._fullLayout[axis(trace.xaxis)], root._fullLayout[axis(trace.yaxis)]];
      const named = (one) => one.title?.text ?? "";
      if (trace.type === "heatmap") {
        const rows = points[0].z.map((line, k) => [trace.y[k], ...Array.from(line, (_, j) => (trace.customdata ? Number(trace.customdata[k][j][0]) : Number(line[j])))]);
        const unit = trace.meta ?? trace.colorbar?.title?.text ?? "";
        blocks.set(`map ${blocks.size}`, [[unit, ...Array.from(trace.x ?? [])], ...rows]);
        return;
      }
      if (trace.visible !== true || points[0].x === false || points.length === 0 || trace.hoverinfo === "skip" && trace.line?.width !== 0) return;
      const own = trace.legendgroup === "modes" || trace.customdata && trace.mode !== "markers" && trace.mode !== "lines";
      const x = points.map((one) => across.type === "category" ? across._categories[one.x] : one.x);
      const key = `${own ? trace.uid : ""}${x.length} ${x[0]} ${x.at(-1)}`;
      const shared = across.matches ? root._fullLayout[axis(across.matches)] : across;
      if (!blocks.has(key)) blocks.set(key, [[named(shared) || named(across) || "x"], ...x.map((one) => [one])]);
      const block = blocks.get(key);
      const edge = trace.line?.width === 0 ? (trace.fill === "tonexty" ? "upper edge of " : "lower edge of ") : "";
      block[0].push(`${edge}${edge ? "what is expected" : trace.name ?? ""}, ${named(up)}`);
      points.forEach((one, k) => block[k + 1]?.push(Number(one.y)));
    });
    return [...blocks.values()].map((block) => block.map((row) => row.map(cell).join(",")).join("\n")).join("\n\n") + "\n";
  }

  // Buttons of a figure for its numbers.
  function saving(root) {
    const icon = (path) => ({ width: 24, height: 24, path });
    const told = (text) => {
      const shown = root();
      shown.dataset.said = text;
      shown.setAttribute("aria-description", text);
    };
    return [
      {
        name: "copy",
        title: "Copy the numbers",
        icon: icon("M8 7h11v14H8z M5 3h11v2H7v12H5z"),
        click: async () => {
          try {
            await navigator.clipboard.writeText(table(root()));
            told("The numbers are copied.");
          } catch {
            told("This browser lets nothing be copied here; save the CSV instead.");
          }
        },
      },
      {
        name: "csv",
        title: "Save the numbers as CSV",
        icon: icon("M11 3h2v9h4l-5 5-5-5h4z M4 19h16v2H4z"),
        click: () => {
          const link = document.createElement("a");
          link.href = URL.createObjectURL(new Blob([table(root())], { type: "text/csv" }));
          link.download = `${root().id || "curves"}.csv`;
          link.click();
          setTimeout(() => URL.revokeObjectURL(link.href), 10000);
        },
      },
    ];
  }

  // A figure as the server made it. `live` are points of one curve, exchanged while a slider is dragged; a click is told as `pick`.
  // Where `keys` names what they mark ("cells" or "lines"), arrow keys and Enter do what a mouse does; `at` [Hz] is where they begin.
  const Plot = {
    props: { figure: Object, live: Object, label: String, tall: Boolean, keys: String, at: Number },
    emits: ["pick"],
    setup: () => ({ root: ref(null) }),
    render() {
      const marking = {
        role: "application",
        tabindex: 0,
        "aria-roledescription": "figure",
        "aria-label": `${this.label}. Arrow keys mark a place, Page Up and Page Down go ten at a time, Enter goes there.`,
        onKeydown: (event) => this.place?.key(event, this.at),
        onFocus: (event) => event.target.matches(":focus-visible") && this.place?.show(this.at),
        onBlur: () => this.place?.hide(),
      };
      const said = this.keys ? marking : { role: "img", "aria-label": this.label };
      return h("div", { ref: "root", class: ["plot", this.tall ? "tall" : ""], ...said });
    },
    async mounted() {
      const Plotly = await library();
      if (!this.$refs.root) return;
      this.Plotly = Plotly;
      this.draw();
      this.sized = new ResizeObserver(() => this.drawn && this.resize());
      this.sized.observe(this.$refs.root);
      if (this.tall) this.sized.observe(this.$refs.root.parentElement);
    },
    beforeUnmount() {
      this.sized?.disconnect();
      if (this.drawn) this.Plotly.purge(this.$refs.root);
    },
    watch: {
      figure() { this.draw(); },
      live() { this.drag(); },
    },
    methods: {
      async draw() {
        const root = this.$refs.root;
        if (!this.Plotly || !root || !this.figure?.data) return;
        this.ahead = false;
        const figure = structuredClone(window.Vue.toRaw(this.figure));
        const layout = figure.layout;
        layout.autosize = true;
        this.least = layout.height;
        delete layout.height;
        this.heighten(layout);
        // Buttons and all else that must hold on every page comes with the library.
        const config = {
          responsive: false,
          toImageButtonOptions: { format: "png", scale: 2, filename: "massline" },
          modeBarButtons: [["toImage", ...saving(() => this.$refs.root)], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]],
        };
        await this.Plotly.react(root, figure.data, layout, config);
        if (!this.drawn) {
          root.on("plotly_click", (event) => this.picked(event.points[0]));
          const { Place, [this.keys]: kind } = window.masslineKeys;
          if (kind) this.place = new Place(root, kind, (place) => this.$emit("pick", place));
          root.on("plotly_afterplot", () => { // zoomed, or of another size
            if (this.ahead) this.bend();
            this.place?.draw();
          });
          this.drawn = true;
        }
        await this.settle();
        root.dataset.drawn = String(Number(root.dataset.drawn ?? 0) + 1);
      },
      drag() {
        if (!this.drawn || !this.live) return;
        const root = this.$refs.root;
        const at = root.data.map((trace, k) => (trace.legendgroup === this.live.group ? k : -1)).filter((k) => k >= 0);
        if (at.length !== this.live.y.length) return;
        const range = [...root._fullLayout.yaxis.range];
        const log = root._fullLayout.yaxis.type === "log";
        const sizes = log ? this.live.y[0].filter((size) => size > 0).map(Math.log10) : this.live.y[0];
        const [low, high] = [Math.min(...sizes), Math.max(...sizes)];
        const beyond = sizes.length > 0 && (high > range[1] || low < range[0]);
        this.ahead = true;
        if (beyond) {
          const wider = log
            ? [Math.max(Math.min(low - 0.1, range[0]), high - 6), Math.max(high + 0.1, range[1])]
            : [Math.min(low, range[0]), Math.max(1.05 * high, range[1])];
          this.Plotly.relayout(root, { "yaxis.range": wider }); // and then bend
        } else {
          this.bend();
        }
        root.dataset.live = String(this.live.number);
      },
      // The curve alone gets its new way. Plotly itself would work out and draw every trace anew, which takes longer than the physics;
      // it gets the points with the next figure, at rest.
      bend() {
        const root = this.$refs.root;
        if (!root || !this.live) return;
        const all = root._fullData.filter((trace) => trace.legendgroup === this.live.group);
        if (all.length !== this.live.y.length) return;
        all.forEach((trace, k) => {
          const [across, up] = [root._fullLayout[axis(trace.xaxis)], root._fullLayout[axis(trace.yaxis)]];
          root.querySelector(`.trace${trace.uid} path.js-line`)?.setAttribute("d", way(this.live.x, this.live.y[k], across, up));
        });
      },
      picked(point) {
        this.$emit("pick", { x: point.x, y: point.y, custom: Array.from(point.customdata ?? []) });
      },
      // A figure that may be scrolled takes the height that there is, and no less than the server asks for; rows of a map share it, and
      // where they are narrower than letters every second and so on bears its name.
      heighten(layout) {
        if (!this.tall) return;
        const height = Math.max(this.least, this.$refs.root.parentElement.clientHeight - 1);
        this.$refs.root.style.height = `${height}px`;
        if (this.keys !== "cells") return; // and tall: the map
        const { margin, yaxis } = layout;
        const row = (height - margin.t - margin.b) / yaxis.categoryarray.length;
        yaxis.tickfont.size = Math.min(11, Math.max(8, row - 1));
        yaxis.tickvals = yaxis.categoryarray.filter((_, k) => k % Math.ceil(9 / row) === 0); // no name touches the next
      },
      resize() {
        const root = this.$refs.root;
        if (!root || root.offsetWidth === 0) return;
        this.heighten(root.layout);
        this.Plotly.Plots.resize(root).then(() => this.settle());
      },
      // A legend above the curves takes as many rows as it needs: they begin below it, and so do headings of theirs (`meta.above`).
      async settle() {
        const root = this.$refs.root;
        const legend = root?._fullLayout?.legend;
        const drawn = root?.querySelector(".legend");
        if (!drawn || legend.orientation !== "h" || legend.yref !== "container") return;
        const wanted = Math.ceil(drawn.getBBox().height) + 8 + (root.layout.meta?.above ?? 0);
        if (Math.abs(root.layout.margin.t - wanted) > 1) await this.Plotly.relayout(root, { "margin.t": wanted });
      },
    },
  };

  const REST = 800; // milliseconds after which a slider that was moved takes the server's word again

  // A slider that goes with the hand, whatever is still being computed for where it was.
  const Slider = {
    props: { at: Number, label: String, text: String },
    emits: ["drag"],
    render() {
      return h("input", {
        ref: "root",
        type: "range",
        class: "what-if",
        min: 0,
        max: 1000,
        step: 1,
        "aria-label": this.label,
        "aria-valuetext": this.text,
        onInput: (event) => { this.moved = Date.now(); this.$emit("drag", Number(event.target.value)); },
      });
    },
    mounted() { this.$refs.root.value = this.at; },
    updated() { if (Date.now() - (this.moved ?? 0) > REST) this.$refs.root.value = this.at; },
  };

  const shortcut = (event) => event.ctrlKey || event.altKey || event.metaKey; // the browser's own

  // Tabs of a panel: one of them is reached by Tab, the others by arrow keys, which choose.
  const Tabs = {
    props: { label: String, of: Array, at: String, panel: String },
    emits: ["choose"],
    render() {
      const tab = ([name, text]) => h("button", {
        type: "button",
        role: "tab",
        key: name,
        id: `to-${name}`,
        "aria-controls": this.panel,
        "aria-selected": String(name === this.at),
        tabindex: name === this.at ? 0 : -1,
        onClick: () => this.$emit("choose", name),
      }, text);
      return h("div", { class: "tabs", role: "tablist", "aria-label": this.label, onKeydown: this.key }, this.of.map(tab));
    },
    methods: {
      key(event) {
        const all = [...this.$el.children];
        const k = all.indexOf(event.target);
        const to = { ArrowLeft: k - 1, ArrowRight: k + 1, Home: 0, End: -1 }[event.key];
        if (to === undefined || shortcut(event)) return;
        event.preventDefault();
        const next = all.at(to % all.length);
        next.focus();
        next.click();
      },
    },
  };

  // The 6 x 6 entries, a grid: Tab reaches the one that is shown or was visited last, arrow keys the others; Enter shows one.
  const SIDE = 6;
  const Picker = {
    props: { label: String, signs: Array, tints: Array, peaks: Array, entries: Array, load: Number, motion: Number },
    emits: ["choose"],
    data: () => ({ visited: null }), // number of the entry that arrow keys came to; it is where Tab comes back to
    watch: {
      load() { this.leave(); },
      motion() { this.leave(); },
    },
    render() {
      const six = [...Array(SIDE).keys()];
      const stop = this.visited ?? this.load * SIDE + this.motion;
      const cell = (i, j) => {
        const shown = this.load === i && this.motion === j;
        return h("td", { key: j }, h("button", {
          type: "button",
          class: `tint${this.tints[i][j]}`,
          tabindex: stop === i * SIDE + j ? 0 : -1,
          "aria-pressed": String(shown),
          "aria-label": this.entries[i][j],
          title: this.entries[i][j],
          onFocus: () => { this.visited = i * SIDE + j; },
          onClick: () => this.$emit("choose", [i, j]),
        }, this.peaks[i][j]));
      };
      const head = h("tr", [h("td"), ...six.map((j) => h("th", { scope: "col", key: j }, this.signs[j]))]);
      const rows = six.map((i) => h("tr", { key: i }, [h("th", { scope: "row" }, this.signs[i]), ...six.map((j) => cell(i, j))]));
      const of = { class: "picker", role: "grid", "aria-label": this.label, onKeydown: this.key };
      return h("table", of, [h("thead", head), h("tbody", rows)]);
    },
    methods: {
      leave() { if (!this.$el.contains(document.activeElement)) this.visited = null; },
      key(event) {
        const all = [...this.$el.querySelectorAll("button")];
        const k = all.indexOf(event.target);
        const row = k - (k % SIDE);
        const steps = {
          ArrowLeft: Math.max(k - 1, row),
          ArrowRight: Math.min(k + 1, row + SIDE - 1),
          ArrowUp: k - SIDE,
          ArrowDown: k + SIDE,
          Home: row,
          End: row + SIDE - 1,
        };
        if (k < 0 || !(event.key in steps) || shortcut(event)) return;
        event.preventDefault();
        all[steps[event.key]]?.focus();
      },
    },
  };

  const FRAMES = 9; // from one end of the swing to the other
  const PACE = 70; // milliseconds a frame

  // Pictures that the server draws, turned by dragging or by the arrow keys; a mode swings in frames that are fetched once a view.
  const View = {
    props: { version: String, label: String, moves: Boolean, dark: Boolean },
    emits: ["pick"],
    setup: () => ({ az: ref(0), el: ref(0), zoom: ref(1) }),
    data: () => ({ playing: !window.matchMedia("(prefers-reduced-motion: reduce)").matches }),
    render() {
      const canvas = h("canvas", {
        ref: "canvas",
        class: "view",
        tabindex: 0,
        role: "application",
        "aria-roledescription": "picture",
        "aria-label": `${this.label}. Arrow keys turn it, plus and minus zoom, Home goes back.`,
        onPointerdown: this.grab,
        onPointermove: this.move,
        onPointerup: this.release,
        onKeydown: this.key,
        onWheel: this.wheel,
      });
      const button = (text, label, click) => h("button", { type: "button", class: "tool", "aria-label": label, title: label, onClick: click }, text);
      const tools = [
        button("−", "Smaller", () => this.zoomed(1 / 1.25)),
        button("+", "Larger", () => this.zoomed(1.25)),
        button("⟲", "First view", this.home),
      ];
      if (this.moves) {
        tools.unshift(button(this.playing ? "❚❚" : "▶", this.playing ? "Hold the mode still" : "Let the mode swing", this.play));
      }
      return h("div", { class: "viewer" }, [canvas, h("div", { class: "tools" }, tools)]);
    },
    mounted() {
      this.sized = new ResizeObserver(() => this.ask());
      this.sized.observe(this.$refs.canvas);
      this.clock = window.setInterval(() => this.tick(), PACE);
    },
    beforeUnmount() {
      this.sized.disconnect();
      window.clearInterval(this.clock);
    },
    watch: {
      version() { this.ask(); },
      dark() { this.ask(); },
    },
    methods: {
      address(frame) {
        const canvas = this.$refs.canvas;
        const [w, h2] = [Math.round(canvas.clientWidth), Math.round(canvas.clientHeight)];
        const said = { of: this.version, az: this.az.toFixed(3), el: this.el.toFixed(3), zoom: this.zoom.toFixed(3), w, h: h2 };
        return `view.jpg?${new URLSearchParams({ ...said, dark: this.dark ? 1 : 0, frame })}`;
      },
      // One picture at a time is on its way: what was asked meanwhile is asked when it has come.
      async ask() {
        const canvas = this.$refs.canvas;
        if (!this.version || !canvas || canvas.clientWidth < 20) return;
        if (this.asking) {
          this.again = true;
          return;
        }
        this.asking = true;
        this.frames = null;
        canvas.removeAttribute("data-frames");
        const asked = this.address(this.moves ? FRAMES - 1 : 0);
        const picture = await this.fetched(asked);
        this.asking = false;
        if (picture) this.show(picture);
        if (!this.$refs.canvas) return; // another tab was chosen meanwhile
        if (this.again) {
          this.again = false;
          this.ask();
        } else if (picture && this.moves) {
          this.fetchFrames(asked);
        }
      },
      async fetchFrames(asked) {
        const frames = [];
        for (let k = 0; k < FRAMES; k += 1) {
          if (!this.$refs.canvas || this.address(FRAMES - 1) !== asked) return;
          const picture = await this.fetched(this.address(k));
          if (!picture) return;
          frames.push(picture);
        }
        this.frames = [...frames, ...frames.slice(1, -1).reverse()];
        this.$refs.canvas?.setAttribute("data-frames", String(this.frames.length));
      },
      fetched(address) {
        return new Promise((done) => {
          const picture = new Image();
          picture.onload = () => done(picture);
          picture.onerror = () => done(null);
          picture.src = address;
        });
      },
      show(picture) {
        const canvas = this.$refs.canvas;
        if (!canvas) return;
        if (canvas.width !== picture.width || canvas.height !== picture.height) {
          canvas.width = picture.width;
          canvas.height = picture.height;
        }
        canvas.getContext("2d").drawImage(picture, 0, 0);
        canvas.dataset.shown = String(Number(canvas.dataset.shown ?? 0) + 1);
      },
      tick() {
        if (!this.frames || !this.playing) return;
        this.at = ((this.at ?? -1) + 1) % this.frames.length;
        this.show(this.frames[this.at]);
      },
      play() { this.playing = !this.playing; },
      home() {
        [this.az, this.el, this.zoom] = [0, 0, 1];
        this.ask();
      },
      zoomed(factor) {
        this.zoom = Math.min(8, Math.max(0.4, this.zoom * factor));
        this.ask();
      },
      turned(az, el) {
        this.az = (this.az + az) % 360;
        this.el = Math.min(70, Math.max(-100, this.el + el));
        this.ask();
      },
      grab(event) {
        this.held = [event.clientX, event.clientY];
        this.began = [event.clientX, event.clientY];
        event.target.setPointerCapture(event.pointerId);
      },
      move(event) {
        if (!this.held) return;
        const [x, y] = this.held;
        this.held = [event.clientX, event.clientY];
        this.turned(-0.5 * (event.clientX - x), 0.5 * (event.clientY - y));
      },
      release(event) {
        this.held = null;
        const box = this.$refs.canvas.getBoundingClientRect();
        const went = this.began ? Math.hypot(event.clientX - this.began[0], event.clientY - this.began[1]) : 99;
        if (went < 4) this.picked(event.clientX - box.left, event.clientY - box.top);
      },
      // A click that turned nothing, or Enter for the middle of the picture.
      picked(x, y) {
        const { clientWidth: w, clientHeight: h2 } = this.$refs.canvas;
        this.$emit("pick", { x, y, w: Math.round(w), h: Math.round(h2), az: this.az, el: this.el, zoom: this.zoom });
      },
      wheel(event) {
        event.preventDefault();
        this.zoomed(event.deltaY < 0 ? 1.1 : 1 / 1.1);
      },
      key(event) {
        const done = {
          Enter: () => this.picked(this.$refs.canvas.clientWidth / 2, this.$refs.canvas.clientHeight / 2),
          ArrowLeft: () => this.turned(10, 0),
          ArrowRight: () => this.turned(-10, 0),
          ArrowUp: () => this.turned(0, 10),
          ArrowDown: () => this.turned(0, -10),
          "+": () => this.zoomed(1.25),
          "-": () => this.zoomed(1 / 1.25),
          Home: () => this.home(),
        }[event.key];
        if (!done || shortcut(event)) return;
        event.preventDefault();
        done();
      },
    },
  };

  async function walked(entry, path, found) {
    if (entry.isFile) {
      const file = await new Promise((done, failed) => entry.file(done, failed));
      found.push([`${path}${entry.name}`, file]);
      return;
    }
    const reader = entry.createReader();
    for (;;) {
      const some = await new Promise((done, failed) => reader.readEntries(done, failed));
      if (some.length === 0) return;
      for (const one of some) await walked(one, `${path}${entry.name}/`, found);
    }
  }

  // Files and folders, dropped or chosen, sent to the desk with the names they have there.
  const Drop = {
    props: { busy: Boolean },
    emits: ["sent"],
    setup: () => ({ over: ref(false), words: ref("") }),
    render() {
      const input = (label, id, extra) => [
        h("label", { for: id, class: "choose" }, label),
        h("input", { id, type: "file", multiple: true, class: "hidden-input", onChange: (event) => this.chosen(event), ...extra }),
      ];
      return h(
        "div",
        {
          class: ["drop", this.over ? "over" : ""],
          onDragover: (event) => { event.preventDefault(); this.over = true; },
          onDragleave: () => { this.over = false; },
          onDrop: (event) => this.dropped(event),
        },
        [
          h("p", { class: "drop-words" }, "Drag a folder or files here: a model (.toml), campaign folders, weigh, cog and pendulum files."),
          h("p", { class: "chooses" }, [...input("Choose a folder", "choose-folder", { webkitdirectory: true }), ...input("Choose files", "choose-files", {})]),
          h("p", { role: "status", class: "drop-words" }, this.words),
        ],
      );
    },
    methods: {
      async dropped(event) {
        event.preventDefault();
        this.over = false;
        const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter(Boolean);
        const found = [];
        for (const entry of entries) await walked(entry, "", found);
        this.send(found);
      },
      chosen(event) {
        this.send([...event.target.files].map((file) => [file.webkitRelativePath || file.name, file]));
        event.target.value = "";
      },
      async send(found) {
        if (found.length === 0) return;
        if (this.busy) {
          this.words = "Something is being read or computed. Hand the files over when that is done.";
          return;
        }
        this.words = `${found.length} file${found.length === 1 ? "" : "s"} on the way ...`;
        const form = new FormData();
        for (const [name, file] of found) form.append(encodeURIComponent(name), file, "file");
        try {
          const answer = await fetch("files", { method: "POST", body: form });
          this.words = answer.ok ? "" : await answer.text();
          if (answer.ok) this.$emit("sent");
        } catch {
          this.words = "The files did not arrive; the workbench may have ended.";
        }
      },
    },
  };

  // Tells whether the page is dark: as the system is, unless the user chose. Tells start.js of rungs that nobody has saved.
  const Scheme = {
    props: { choice: String, unsaved: Boolean },
    emits: ["dark"],
    render: () => null,
    mounted() {
      this.system = window.matchMedia("(prefers-color-scheme: dark)");
      this.tell = () => this.$emit("dark", this.choice === "system" ? this.system.matches : this.choice === "dark");
      this.system.addEventListener("change", this.tell);
      this.tell();
    },
    beforeUnmount() {
      this.system.removeEventListener("change", this.tell);
    },
    watch: {
      choice() { this.tell(); },
      unsaved: { immediate: true, handler() { window.massline.unsaved = this.unsaved; } },
    },
  };

  window.massline = {
    install(app) {
      app.component("MasslinePlot", Plot);
      app.component("MasslineTabs", Tabs);
      app.component("MasslinePicker", Picker);
      app.component("MasslineView", View);
      app.component("MasslineSlider", Slider);
      app.component("MasslineDrop", Drop);
      app.component("MasslineScheme", Scheme);
    },
  };
})();
