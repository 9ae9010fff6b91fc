// What Material's script makes of code and tables, for readers without eyes or mouse.
(() => {
  const reach = (table) => {
    if (table.scrollWidth > table.clientWidth) table.setAttribute("tabindex", "0");
    else table.removeAttribute("tabindex");
  };
  const sizes = new ResizeObserver((entries) => entries.forEach((entry) => reach(entry.target)));

  const improve = () => {
    // Each block of code has buttons, and is not a part of the page to jump to.
    for (const buttons of document.querySelectorAll("nav.md-code__nav:not([role])")) buttons.setAttribute("role", "none");
    // A wide table scrolls: keys must reach it too.
    for (const table of document.querySelectorAll(".md-typeset__scrollwrap:not([data-reached])")) {
      table.dataset.reached = "";
      sizes.observe(table);
    }
  };
  improve();
  new MutationObserver(improve).observe(document.body, { childList: true, subtree: true });
})();
