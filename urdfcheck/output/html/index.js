"use strict";
// Filters rows that are there, and offers the command that makes the report of a model.
const models = document.querySelector("#models tbody");
const find = document.getElementById("find");
const state = document.getElementById("status");
const shown = document.getElementById("shown");
let texts;

// A button for each model without a page: the command that makes its report. Thousands of buttons would make the page slow.
const MOST_BUTTONS = 300;

function offer(rows) {
  let room = MOST_BUTTONS;
  for (const row of rows) {
    if (row.hidden || row.dataset.path === undefined) continue;
    if (!room--) return;
    if (row.querySelector(".copy-command")) continue;
    const button = document.createElement("button");
    const path = /^[\w@%+=:,./-]+$/.test(row.dataset.path) ? row.dataset.path : `'${row.dataset.path.replaceAll("'", "'\\''")}'`;
    button.type = "button";
    button.className = "copy-command";
    button.dataset.command = `urdfcheck ${path} -o html=report.html`;
    button.title = button.dataset.command;
    button.textContent = "Copy command";
    button.setAttribute("aria-label", `Copy the command that makes the report of ${row.dataset.path}`);
    row.cells[0].append(" ", button);
  }
}
for (const body of document.querySelectorAll("#worst tbody, #models tbody")) offer(body.rows);

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
  offer(models.rows);
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
