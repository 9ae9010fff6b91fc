"use strict";
// Filters rows that are there, and offers the command that makes the report of a model.
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
