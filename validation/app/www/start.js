// Begins the page, unless another tab holds the window of this address (a duplicated tab): then this one gets a window of its own.
(async () => {
  const module = document.currentScript.dataset.module;
  const held = async () => (await (await fetch("open")).json()).open;
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let tried = 0; await held(); tried += 1) {
    if (tried === 5) {
      window.location.replace("/");
      return;
    }
    await pause(150); // a reload: the page before this one is still letting go
  }
  const script = document.createElement("script");
  script.type = "module";
  script.src = module;
  document.head.append(script);
})();
