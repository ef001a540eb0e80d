() => {
  // Controls that say nothing to somebody who does not see them.
  const named = (one) =>
    (one.getAttribute("aria-label") || one.innerText || one.title || "").trim() ||
    (one.getAttribute("aria-labelledby") ?? "").split(" ").map((id) => document.getElementById(id)?.innerText ?? "").join("").trim() ||
    [...(one.labels ?? [])].map((label) => label.innerText).join("").trim();
  const all = document.querySelectorAll("button, a[href], input, select, textarea, [role=slider], [role=button], [role=tab], [role=combobox], canvas, [role=img], [role=application], [role=tabpanel], [tabindex='0']");
  return [...all].filter((one) => one.getClientRects().length && !one.closest("[aria-hidden=true], .modebar") && !named(one)).map((one) => one.outerHTML.slice(0, 160));
}
