"use strict";
// Sorts and filters rows that are there. It reads their text and puts none of it anywhere.
const collator = new Intl.Collator("en", { numeric: true });

for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const before = head.getAttribute("aria-sort");
      const first = body.rows[0]?.cells[column].dataset.v === undefined ? "ascending" : "descending";
      const now = before === null ? first : before === "ascending" ? "descending" : "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", now);
      const sign = now === "ascending" ? 1 : -1;
      const rows = [...body.rows].map((row) => {
        const cell = row.cells[column];
        return [cell.dataset.v === undefined ? cell.textContent : Number(cell.dataset.v), row];
      });
      rows.sort(([a], [b]) => sign * (typeof a === "number" ? a - b : collator.compare(a, b)));
      const sorted = document.createDocumentFragment();
      for (const [, row] of rows) sorted.append(row);
      body.append(sorted);
      table.parentElement.scrollTop = 0;
    });
  });
}

const models = document.querySelector("#models tbody");
const find = document.getElementById("find");
const state = document.getElementById("status");
const shown = document.getElementById("shown");
let texts;

function filter() {
  texts ??= [...models.rows].map((row) => [row, `${row.textContent} ${row.dataset.codes ?? ""}`.toLowerCase()]);
  const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const [row, text] of texts) {
    const hit = (!state.value || row.dataset.status === state.value) && words.every((word) => text.includes(word));
    if (row.hidden === hit) row.hidden = !hit;
    count += hit;
  }
  models.closest(".scroll").scrollTop = 0;
  shown.textContent = count === texts.length ? "" : `${count} of ${texts.length} shown`;
}

find.addEventListener("input", filter);
state.addEventListener("change", filter);
for (const link of document.querySelectorAll("a[data-find]")) {
  link.addEventListener("click", () => {
    find.value = link.dataset.find;
    state.value = "";
    filter();
  });
}
document.querySelector(".tools").hidden = false;
