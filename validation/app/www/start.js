// Before it is left with rungs that nobody has saved, the browser asks; trame's own listener comes later and would let go of the
// server at once, which whoever then stays still needs.
window.addEventListener("beforeunload", (event) => {
  if (!window.massline?.unsaved) return;
  event.preventDefault();
  event.stopImmediatePropagation();
}, true);

// Begins the page, unless another tab holds the window of this address (a duplicated tab): then this one gets a window of its own.
// A reload never does: the page before it is still letting go, however long that takes on a busy machine.
(async () => {
  const module = document.currentScript.dataset.module;
  const reloaded = performance.getEntriesByType("navigation")[0]?.type === "reload";
  const held = async () => (await (await fetch("open")).json()).open;
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let tried = 0; tried < (reloaded ? 40 : 5) && (await held()); tried += 1) {
    if (tried === 4 && !reloaded) {
      window.location.replace("/");
      return;
    }
    await pause(150);
  }
  const script = document.createElement("script");
  script.type = "module";
  script.src = module;
  document.head.append(script);
})();
