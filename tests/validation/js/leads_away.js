// What a click could follow out of this page: links, forms, frames and what an SVG links to.
() => {
  const away = (address) => address && !/^(?:#|data:|blob:|about:|javascript:void)/.test(address) && new URL(address, location.href).origin !== location.origin;
  const told = [...document.querySelectorAll("*")].flatMap((one) =>
    ["href", "xlink:href", "action", "formaction", "src", "ping", "target"].map((name) => [name, one.getAttribute(name)])
      .filter(([name, value]) => (name === "target" ? Boolean(value) : away(value)))
      .map(([name, value]) => `${one.tagName} ${name}=${value}`));
  return told;
}
