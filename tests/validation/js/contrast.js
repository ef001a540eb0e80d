() => {
  // Every visible text whose colour stands less than 4.5 to 1 (3 to 1 where it is large) against what lies behind it.
  const parts = (text) => { const found = text.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0, 0]; return [...found.slice(0, 3), found[3] ?? 1]; };
  const over = (top, below) => top.slice(0, 3).map((one, k) => one * top[3] + below[k] * (1 - top[3]));
  const light = (rgb) => {
    const [r, g, b] = rgb.map((one) => { const c = one / 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const known = new Map(); // of every element its ground and how opaque it is, each from its parent's
  const stands = (element) => {
    if (!element) return { ground: [255, 255, 255], share: 1 };
    if (!known.has(element)) {
      const [style, below] = [getComputedStyle(element), stands(element.parentElement)];
      known.set(element, { ground: over(parts(style.backgroundColor), below.ground), share: below.share * Number(style.opacity) });
    }
    return known.get(element);
  };
  const poor = [];
  for (const element of document.querySelectorAll("body *")) {
    const text = [...element.childNodes].filter((one) => one.nodeType === 3).map((one) => one.data.trim()).join(" ").trim();
    if (!text) continue;
    const box = element.getBoundingClientRect();
    const style = getComputedStyle(element);
    if (box.width < 1 || box.height < 1 || style.visibility === "hidden" || box.right < 0) continue;
    if (element.closest("[disabled], .v-btn--disabled, .v-input--disabled, [aria-hidden=true], .v-overlay-container, .heatmap-label, script, style")) continue;
    const { ground, share } = stands(element);
    if (share < 0.05) continue;
    const ink = parts(element instanceof SVGElement ? style.fill : style.color);
    const seen = over([...ink.slice(0, 3), ink[3] * share], ground);
    const [bright, dark] = [light(seen), light(ground)].sort((a, b) => b - a);
    const ratio = (bright + 0.05) / (dark + 0.05);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    if (ratio < (large ? 3 : 4.5)) poor.push(`${ratio.toFixed(2)}: ${text.slice(0, 40)} (${element.tagName}.${element.getAttribute("class")})`);
  }
  return poor;
}
