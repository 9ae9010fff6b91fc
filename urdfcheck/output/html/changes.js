"use strict";
// Leads from a change, a finding or a cause to the parts of the robot, and back. All that it shows is in the page.
{
const { root, by, main, narrow, tell, reveal, arrive, keys, viewer } = frame;
const back = by("back");
const entries = [...main.querySelectorAll(".entry, .card")];
let current = null;

// The links that the 3D view shows for each row.
const staged = new Map();
for (const { id: model, findings } of JSON.parse(by("uc-data")?.textContent ?? '{"models": []}').models) {
  for (const { id, links } of findings) staged.set(id, links.map((name) => `${model} ${name}`));
}

function mark(about = []) {
  for (const entry of entries) entry.classList.toggle("about", about.includes(entry));
}

function forget() {
  current?.removeAttribute("aria-current");
  current = null;
  back.hidden = true;
  back.parentElement.hidden = true;
  mark();
}

function show() {
  if (current) tell("uc:select", { model: current.closest(".model").id, finding: current.id, origin: "page" });
}

function unfold(element) {
  for (let box = element.parentElement; box !== main; box = box.parentElement) if (box.tagName === "DETAILS") box.open = true;
}

function choose(entry, { scroll = false } = {}) {
  forget();
  current = entry;
  unfold(entry);
  entry.setAttribute("aria-current", "true");
  if (scroll) {
    entry.focus({ preventScroll: true });
    entry.scrollIntoView({ block: "nearest" });
  }
  show();
}

function address(id) {
  try {
    history.replaceState(null, "", id ? `#${id}` : location.pathname + location.search);
  } catch {
    // A file may not change its address in every browser.
  }
}

function clear() {
  forget();
  address("");
  tell("uc:clear", { origin: "page" });
}

function step(places) {
  const order = entries.filter((entry) => entry.checkVisibility());
  const next = order[Math.min(Math.max(order.indexOf(current) + places, 0), order.length - 1)];
  if (!next) return;
  choose(next, { scroll: true });
  address(next.id);
}

// The robot is above all rows on a narrow page.
function offerReturn() {
  back.hidden = back.parentElement.hidden = !narrow.matches;
  back.textContent = "Back to the row";
}
back.addEventListener("click", () => {
  if (!current) return;
  const entry = current;
  choose(entry);
  entry.scrollIntoView({ block: "center" });
});

main.addEventListener("click", ({ target }) => {
  const entry = target.closest(".entry, .card");
  const button = target.closest(".in-3d");
  if (button?.dataset.link !== undefined || button?.dataset.joint !== undefined || button?.classList.contains("whole")) {
    reveal();
    forget();
    tell("uc:select", { model: button.closest(".model").id, ...button.dataset, origin: "page" });
    return;
  }
  if (!entry || target.closest("a, summary, label, input") || (!button && target.closest("button"))) return;
  if (!button && !getSelection().isCollapsed) return;
  const more = entry.querySelector(".more");
  if (more && !button && !target.closest(".more, .frame")) more.open = !more.open;
  if (button) reveal();
  choose(entry);
  address(entry.id);
  if (button) offerReturn();
});

document.addEventListener("uc:select", ({ detail }) => {
  if (detail.origin !== "viewer") return;
  forget();
  const about = entries.filter(({ id }) => staged.get(id)?.includes(`${detail.model} ${detail.link}`));
  mark(about);
  if (about.length && !narrow.matches) {
    unfold(about[0]);
    about[0].scrollIntoView({ block: "center" });
  }
});
document.addEventListener("uc:clear", ({ detail }) => {
  if (detail.origin === "viewer") forget();
});
// What was chosen before there was a robot to show it.
if (viewer) new MutationObserver(show).observe(document.body, { attributes: true, attributeFilter: ["data-ready"] });

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || keys.open) return;
  if (event.target.closest?.("input, select, textarea, [contenteditable]")) return;
  if (event.key === "Escape") clear();
  else if (event.key === "?") keys.showModal();
  else if (event.key === "j") step(1);
  else if (event.key === "k") step(-1);
  else return;
  event.preventDefault();
});

function follow() {
  const target = by(location.hash.slice(1));
  if (!target || !main.contains(target)) return;
  unfold(target);
  if (target.matches("details > *")) target.parentElement.open = true;
  const entry = target.closest(".entry, .card");
  if (entry) choose(entry, { scroll: true });
  else arrive(target);
}
addEventListener("hashchange", follow);
addEventListener("load", follow);
}
