"use strict";
// Sorts the tables that can be sorted, and copies. It moves rows that are there and puts none of their text anywhere.
document.documentElement.dataset.js = "";
{
const collator = new Intl.Collator("en", { numeric: true });
const superscripts = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";

// The last cell of the head above each column: a head may have two rows.
function headsOf(table) {
  const grid = [];
  Array.from(table.tHead.rows, (row, r) => {
    let column = 0;
    grid[r] ??= [];
    for (const cell of row.cells) {
      while (grid[r][column]) column += 1;
      for (let i = 0; i < cell.rowSpan; i += 1)
        for (let k = 0; k < cell.colSpan; k += 1) (grid[r + i] ??= [])[column + k] = cell;
      column += cell.colSpan;
    }
  });
  return grid.at(-1);
}

// A number where the text is one: 1.3×10⁻⁵, −4, 12 000, 3 × 4. What is missing is NaN.
function read(cell, isNumber) {
  if (!isNumber) return cell ? cell.textContent.trim() : "";
  if (!cell) return NaN;
  if (cell.dataset.v !== undefined) return Number(cell.dataset.v);
  const text = cell.textContent.replace(/[\u202f\s]/g, "").replace(/−/g, "-").replace(/×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/, (_, power) =>
    `e${Array.from(power, (sign) => "-0123456789"[superscripts.indexOf(sign)]).join("")}`);
  return parseFloat(text);
}

function cellAt(row, column) {
  let at = 0;
  for (const cell of row.cells) {
    if (at === column && cell.colSpan === 1) return cell;
    at += cell.colSpan;
  }
  return undefined;
}

function sort(table, heads, column) {
  const head = heads[column];
  const body = table.tBodies[0];
  const isNumber = head.classList.contains("num") || cellAt(body.rows[0], column)?.dataset.v !== undefined;
  const before = head.getAttribute("aria-sort");
  const now = before === null ? (isNumber ? "descending" : "ascending") : before === "ascending" ? "descending" : "ascending";
  for (const other of heads) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", now);
  const sign = now === "ascending" ? 1 : -1;
  const rows = Array.from(body.rows, (row) => [read(cellAt(row, column), isNumber), row]);
  const lacks = (value) => (isNumber ? Number.isNaN(value) : value === "" || value === "—");
  // What is missing is last in either order.
  rows.sort(([a], [b]) => lacks(a) - lacks(b) || (lacks(a) ? 0 : sign * (isNumber ? a - b : collator.compare(a, b))));
  const sorted = document.createDocumentFragment();
  for (const [, row] of rows) sorted.append(row);
  body.append(sorted);
  table.parentElement.scrollTop = 0;
}

for (const table of document.querySelectorAll("table.sortable")) {
  if (!table.tBodies[0]?.rows.length) continue;
  const heads = headsOf(table);
  heads.forEach((head, column) => {
    if (head.colSpan > 1 || head.querySelector(".sr:only-child")) return;
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => sort(table, heads, column));
  });
}
}

async function copyText(text, button, what) {
  let isDone = true;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    isDone = document.execCommand("copy");
    area.remove();
    button.focus();
  }
  const said = document.getElementById("said");
  said.textContent = isDone ? `${what} copied` : `${what} could not be copied`;
  if (button.dataset.wait) return;
  const before = [...button.childNodes];
  button.dataset.wait = "1";
  button.textContent = isDone ? (button.classList.contains("copy-place") ? "✓" : "Copied") : "Not copied";
  setTimeout(() => {
    button.replaceChildren(...before);
    delete button.dataset.wait;
    said.textContent = "";
  }, 1500);
}
document.addEventListener("click", ({ target }) => {
  const button = target.closest(".copy-command");
  if (button) copyText(button.dataset.command ?? button.parentElement.querySelector("code").textContent, button, "The command");
});
