"use strict";
// Searches, filters, groups, chooses and copies. All that it shows is in the page: it moves and hides elements, and what it
// writes of a file goes through textContent.
{
const root = document.documentElement;
const by = (id) => document.getElementById(id);
const main = by("content");
const viewer = by("viewer");
const tell = (name, detail) => document.dispatchEvent(new CustomEvent(name, { detail }));
const narrow = matchMedia("(max-width: 79.99rem)");
root.dataset.js = "";

// -- the findings -----------------------------------------------------------------------------------------------------

const elementOf = ({ dataset }) =>
  dataset.link !== undefined ? `link ${dataset.link}` : dataset.joint !== undefined ? `joint ${dataset.joint}` : "";

// The links and joints that the 3D view shows for a finding are more than its subjects.
const staged = new Map();
for (const { findings } of JSON.parse(by("uc-data")?.textContent ?? '{"models": []}').models) {
  for (const { id, links, joints } of findings) {
    staged.set(id, [...links.map((name) => `link ${name}`), ...joints.map((name) => `joint ${name}`)]);
  }
}

const lines = new Map();
for (const link of main.querySelectorAll(".contents a")) lines.set(link.hash.slice(1), link.parentElement);

const findings = Array.from(main.querySelectorAll(".card"), (card) => {
  const subjects = card.querySelector(".subjects");
  const elements = [
    ...Array.from(subjects?.parentElement.querySelectorAll(".subjects li") ?? [], elementOf),
    ...(staged.get(card.id) ?? []),
  ];
  const head = card.querySelector("h4").textContent;
  const text = [head, card.querySelector(".headline").textContent, card.querySelector(".message").textContent, subjects?.textContent, card.dataset.file];
  return {
    card,
    home: card.parentElement,
    model: card.closest(".model"),
    line: lines.get(card.id),
    severity: ["error", "warning", "info"].find((severity) => card.classList.contains(severity)),
    known: card.classList.contains("known"),
    code: card.dataset.code,
    confidence: card.dataset.confidence,
    elements: [...new Set(elements)].filter(Boolean),
    text: text.join(" ").toLowerCase(),
    rule: head.replace(/^\s*\w+\s+/, "").trim(),
    shown: true,
  };
});
const ofCard = new Map(findings.map((finding) => [finding.card, finding]));

// -- search and filters -----------------------------------------------------------------------------------------------

const find = by("find");
const rule = by("by-rule");
const element = by("by-element");
const confidence = by("by-confidence");
const withKnown = by("with-known");
const group = by("group");
const state = document.querySelector(".state");
const chip = by("chip");
const back = by("back");
const tiles = document.querySelectorAll(".tile input");
// What was clicked in the 3D view, as {model, name}; the list of elements knows no model.
let picked = null;
const opened = new Set();

function fill(select, options) {
  for (const [value, label] of [...options].sort(([a], [b]) => a.localeCompare(b, "en", { numeric: true }))) {
    select.add(new Option(label, value));
  }
}
const counted = (finding) => !finding.known || Boolean(withKnown?.checked);
fill(rule, new Map(findings.map(({ code, rule }) => [code, rule])));
fill(element, new Map(findings.flatMap(({ elements }) => elements.map((name) => [name, name]))));
fill(confidence, new Map(findings.map(({ confidence }) => [confidence, confidence])));

function filter() {
  const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
  const off = Array.from(tiles).flatMap((box) => (box.checked ? [] : [box.id.replace("show-", "")]));
  const isActive = Boolean(words.length || off.length || rule.value || element.value || confidence.value || picked);
  let total = 0;
  let count = 0;
  const kept = new Map();
  for (const finding of findings) {
    const isCounted = counted(finding);
    finding.shown =
      (!isCounted && !isActive) ||
      (isCounted &&
        !off.includes(finding.severity) &&
        (!rule.value || finding.code === rule.value) &&
        (!confidence.value || finding.confidence === confidence.value) &&
        (!element.value || finding.elements.includes(element.value)) &&
        (!picked || (finding.model.id === picked.model && finding.elements.includes(picked.name))) &&
        words.every((word) => finding.text.includes(word)));
    total += isCounted;
    count += isCounted && finding.shown;
    if (finding.card.hidden === finding.shown) finding.card.hidden = !finding.shown;
    if (finding.line && finding.line.hidden === finding.shown) finding.line.hidden = !finding.shown;
    if (!finding.shown) continue;
    for (let box = finding.card.parentElement; box !== main; box = box.parentElement) kept.set(box, (kept.get(box) ?? 0) + 1);
  }
  for (const box of main.querySelectorAll(".group, .of-file, .fold, .suppressed")) {
    const number = kept.get(box) ?? 0;
    box.hidden = !number;
    const all = box.querySelectorAll(".card").length;
    const told = box.matches(".suppressed") ? null : box.querySelector(".count");
    if (told) told.textContent = number < all ? `${number} of ${all}` : all;
    if (box.tagName !== "DETAILS") continue;
    // What is searched for must not stay in a fold.
    if (isActive && number && !box.open) {
      box.open = true;
      opened.add(box);
    } else if (!isActive && opened.delete(box)) {
      box.open = false;
    }
  }
  for (const list of main.querySelectorAll(".contents")) {
    const fold = list.closest("details");
    (fold ?? list).hidden = ![...list.children].some((line) => !line.hidden);
  }
  state.hidden = !isActive && back.hidden;
  by("reset").hidden = !isActive;
  by("shown").textContent = isActive ? `${count} of ${total} shown` : "";
  chip.hidden = !picked;
  if (picked) chip.textContent = `${picked.name} \u00d7`;
}

function reset() {
  find.value = rule.value = element.value = confidence.value = "";
  for (const box of tiles) box.checked = true;
  unpick();
}

function unpick() {
  picked = null;
  filter();
}

// What is found must not be out of sight.
function search() {
  filter();
  const first = find.value && findings.find(({ shown, known }) => shown && !known)?.card;
  if (!first) return;
  const { top, bottom } = first.getBoundingClientRect();
  if (bottom < 0 || top > innerHeight) first.scrollIntoView({ block: "start" });
}

let waiting = 0;
find.addEventListener("input", () => {
  clearTimeout(waiting);
  waiting = setTimeout(search, findings.length > 300 ? 120 : 0);
});
for (const control of [rule, element, confidence, ...tiles]) control.addEventListener("change", filter);
by("reset").addEventListener("click", () => {
  reset();
  tell("uc:clear", { origin: "page" });
});
chip.addEventListener("click", () => {
  unpick();
  tell("uc:clear", { origin: "page" });
});
by("more").addEventListener("click", ({ currentTarget }) => {
  const filters = by("filters");
  filters.hidden = !filters.hidden;
  currentTarget.setAttribute("aria-expanded", String(!filters.hidden));
});
by("unfold").addEventListener("click", ({ currentTarget }) => {
  const isOpening = currentTarget.textContent === "Open all";
  for (const { card, shown } of findings) if (shown) card.querySelector(".more").open = isOpening;
  currentTarget.textContent = isOpening ? "Close all" : "Open all";
});

// -- groups -----------------------------------------------------------------------------------------------------------

const WHOLE = "the model as a whole";
const titles = {
  rule: (finding) => finding.rule,
  element: (finding) => finding.elements[0] ?? WHOLE,
  file: ({ card }) => card.dataset.file || WHOLE,
};
let made = [];

function regroup() {
  const title = titles[group.value];
  const groups = new Map();
  for (const finding of findings) {
    if (!title || !counted(finding)) {
      finding.home.append(finding.card);
      continue;
    }
    const places = groups.get(finding.model) ?? new Map();
    groups.set(finding.model, places);
    const name = title(finding);
    const cards = places.get(name) ?? [];
    places.set(name, cards);
    cards.push(finding.card);
  }
  for (const box of made) box.remove();
  made = [];
  for (const [model, places] of groups) {
    const into = model.querySelector(".findings");
    for (const [name, cards] of [...places].sort(([a], [b]) => (a === WHOLE) - (b === WHOLE))) {
      const box = document.createElement("section");
      const head = document.createElement("h3");
      const count = document.createElement("span");
      const list = document.createElement("div");
      box.className = "group";
      count.className = "count";
      count.textContent = cards.length;
      list.className = "cards";
      head.append(cards[0].querySelector(".glyph").cloneNode(true), ` ${name} `, count);
      head.classList.add(ofCard.get(cards[0]).severity);
      list.append(...cards);
      box.append(head, list);
      into.append(box);
      made.push(box);
    }
  }
  filter();
}
group.addEventListener("change", regroup);
withKnown?.addEventListener("change", regroup);

// -- one finding ------------------------------------------------------------------------------------------------------

let current = null;

function forget() {
  current?.card.removeAttribute("aria-current");
  current = null;
  if (back.hidden) return;
  back.hidden = true;
  filter();
}

function show() {
  if (current) tell("uc:select", { model: current.model.id, finding: current.card.id, origin: "page" });
}

function choose(finding, { scroll = false, open = false } = {}) {
  forget();
  current = finding;
  const { card } = finding;
  if (!finding.shown) reset();
  for (let box = card.parentElement; box !== main; box = box.parentElement) if (box.tagName === "DETAILS") box.open = true;
  if (open) card.querySelector(".more").open = true;
  card.setAttribute("aria-current", "true");
  if (scroll) {
    card.focus({ preventScroll: true });
    card.scrollIntoView({ block: "start" });
  }
  show();
}

function address(finding) {
  try {
    history.replaceState(null, "", finding ? `#${finding.card.id}` : location.pathname + location.search);
  } catch {
    // A file may not change its address in every browser.
  }
}

function follow() {
  const target = by(location.hash.slice(1));
  const card = target?.closest(".card");
  if (!card) return;
  choose(ofCard.get(card), { open: true, scroll: target === card });
  if (target !== card) target.scrollIntoView({ block: "center" });
}
addEventListener("hashchange", follow);

function step(places) {
  const order = [...main.querySelectorAll(".card")].filter((card) => !card.hidden && counted(ofCard.get(card)));
  const next = order[Math.min(Math.max(order.indexOf(current?.card) + places, 0), order.length - 1)];
  if (!next) return;
  choose(ofCard.get(next), { scroll: true });
  address(current);
}

function clear() {
  forget();
  address(null);
  tell("uc:clear", { origin: "page" });
}

// -- the robot --------------------------------------------------------------------------------------------------------

const fold = by("fold");

// none | coming (its room is kept) | shown | folded
function arrange(isFolded = root.dataset.viewer === "folded") {
  const isComing = !document.body.dataset.error && "WebGL2RenderingContext" in window && "DecompressionStream" in window;
  root.dataset.viewer = !viewer ? "none" : viewer.hidden ? (isComing ? "coming" : "none") : isFolded ? "folded" : "shown";
  fold.textContent = isFolded ? "Show 3D" : "Hide 3D";
  fold.setAttribute("aria-expanded", String(!isFolded));
  name();
}

// The names of links and joints in tables and lists become buttons.
let isNamed = false;

function name() {
  if (isNamed || root.dataset.viewer !== "shown") return;
  isNamed = true;
  for (const code of main.querySelectorAll("code[data-link], code[data-joint]")) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "in-3d name";
    button.title = "Show in 3D";
    Object.assign(button.dataset, code.dataset);
    code.replaceWith(button);
    button.append(code);
  }
}

function reveal() {
  arrange(false);
  if (narrow.matches) viewer.scrollIntoView({ block: "start" });
}

back.addEventListener("click", () => {
  if (current) choose(current, { scroll: true });
});
fold.addEventListener("click", () => arrange(root.dataset.viewer === "shown"));
arrange();
if (viewer) {
  new MutationObserver(() => arrange()).observe(viewer, { attributes: true, attributeFilter: ["hidden"] });
  // What was chosen before there was a robot to show it.
  new MutationObserver(show).observe(document.body, { attributes: true, attributeFilter: ["data-ready"] });
  new MutationObserver(() => arrange()).observe(document.body, { attributes: true, attributeFilter: ["data-error"] });
}

document.addEventListener("uc:select", ({ detail }) => {
  if (detail.origin !== "viewer") return;
  const finding = detail.finding && ofCard.get(by(detail.finding));
  if (finding) {
    choose(finding, { scroll: true, open: true });
    return;
  }
  const name = detail.link !== undefined ? `link ${detail.link}` : detail.joint !== undefined ? `joint ${detail.joint}` : "";
  forget();
  picked = name ? { model: detail.model, name } : null;
  filter();
  // Under the head of their group; where the robot is above them it stays in sight.
  const first = picked && findings.find(({ shown, known }) => shown && !known)?.card;
  if (first && !narrow.matches) (first.closest(".group").querySelector("h3") ?? first).scrollIntoView({ block: "start" });
});
document.addEventListener("uc:clear", ({ detail }) => {
  if (detail.origin !== "viewer") return;
  forget();
  unpick();
});

main.addEventListener("click", (event) => {
  const { target } = event;
  const card = target.closest(".card");
  const button = target.closest(".in-3d");
  if (button) {
    reveal();
    if (elementOf(button) || !card) {
      forget();
      tell("uc:select", { model: button.closest(".model").id, ...button.dataset, origin: "page" });
    } else {
      choose(ofCard.get(card));
      address(current);
      // The robot is above all findings there.
      back.hidden = !narrow.matches;
      back.textContent = `Back to ${current.code}`;
      filter();
    }
    return;
  }
  const drawn = target.closest("a") ? null : target.closest("svg [data-link], svg [data-joint]");
  if (drawn && root.dataset.viewer !== "none") {
    reveal();
    forget();
    tell("uc:select", { model: drawn.closest(".model").id, ...drawn.dataset, origin: "page" });
    return;
  }
  const anchor = target.closest('a[href^="#f-"]');
  if (anchor && anchor.hash === location.hash) follow();
  if (card && !target.closest("a, button, summary, label, input") && getSelection().isCollapsed) {
    choose(ofCard.get(card));
    address(current);
  }
});

// -- keys, copies, theme ----------------------------------------------------------------------------------------------

const keys = by("keys");
by("help").addEventListener("click", () => keys.showModal());
by("close-keys").addEventListener("click", () => keys.close());

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || keys.open) return;
  const isTyping = event.target.closest?.("input, select, textarea, [contenteditable]");
  if (event.key === "Escape") {
    if (isTyping) {
      if (event.target === find) find.value = "";
      event.target.blur();
    }
    reset();
    clear();
    return;
  }
  if (isTyping) return;
  if (event.key === "/") find.focus();
  else if (event.key === "?") keys.showModal();
  else if (event.key === "j") step(1);
  else if (event.key === "k") step(-1);
  else if (event.key === "Enter" && current && event.target === current.card) {
    const more = current.card.querySelector(".more");
    more.open = !more.open;
  } else return;
  event.preventDefault();
});

async function copy(text, button, what) {
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
  }
  by("said").textContent = isDone ? `${what} copied` : `${what} could not be copied`;
  const before = button.textContent;
  button.textContent = isDone ? "Copied" : "Not copied";
  setTimeout(() => {
    button.textContent = before;
    by("said").textContent = "";
  }, 1500);
}
main.addEventListener("click", ({ target }) => {
  if (target.matches(".copy-diff")) copy(target.closest(".fix").querySelector(".diff").textContent, target, "The diff");
  if (target.matches(".copy-link")) {
    const { href, hash } = location;
    copy(`${href.slice(0, href.length - hash.length)}#${target.closest(".card").id}`, target, "The link");
  }
});

const theme = by("theme");
const themes = ["auto", "light", "dark"];

function paint(name) {
  if (name === "auto") delete root.dataset.theme;
  else root.dataset.theme = name;
  theme.textContent = `Theme: ${name}`;
  try {
    sessionStorage.setItem("urdfcheck-theme", name);
  } catch {
    // A file may have no storage.
  }
  tell("uc:theme", {});
}
theme.addEventListener("click", () => paint(themes[(themes.indexOf(root.dataset.theme ?? "auto") + 1) % 3]));
try {
  const kept = sessionStorage.getItem("urdfcheck-theme");
  if (themes.includes(kept) && kept !== "auto") paint(kept);
} catch {
  // As above.
}

// -- where in the page ------------------------------------------------------------------------------------------------

const ways = new Map();
for (const link of document.querySelectorAll(".bar nav a")) {
  const section = by(link.hash.slice(1));
  if (section) ways.set(section, link);
}
const menu = document.querySelector(".menu");
document.addEventListener("click", ({ target }) => {
  if (menu && !target.closest(".menu > summary")) menu.open = false;
});
const inSight = new Set();
const watch = new IntersectionObserver(
  (entries) => {
    for (const { target, isIntersecting } of entries) inSight[isIntersecting ? "add" : "delete"](target);
    const here = [...ways.keys()].filter((section) => inSight.has(section)).pop();
    for (const [section, link] of ways) {
      if (section !== here) link.removeAttribute("aria-current");
      else if (!link.hasAttribute("aria-current")) {
        link.setAttribute("aria-current", "true");
        const nav = link.closest("nav");
        nav.scrollLeft = link.offsetLeft - (nav.clientWidth - link.offsetWidth) / 2;
      }
    }
  },
  { rootMargin: "-25% 0px -70% 0px" },
);
for (const section of ways.keys()) watch.observe(section);

follow();

// What is above a section gets its height as it is drawn, after the browser's own jump: go on until the section stays.
function arrive(section, tries = 20) {
  const before = section.getBoundingClientRect().top;
  section.scrollIntoView({ block: "start" });
  if (tries && (tries > 17 || Math.abs(section.getBoundingClientRect().top - before) > 1))
    requestAnimationFrame(() => arrive(section, tries - 1));
}

function arriveAtAddress() {
  const section = by(location.hash.slice(1));
  if (section && !section.closest(".card")) arrive(section);
}
addEventListener("load", arriveAtAddress);
addEventListener("hashchange", arriveAtAddress);
document.addEventListener("click", ({ target }) => {
  const link = target.closest('a[href^="#"]');
  if (link && link.hash === location.hash) arriveAtAddress(); // no change of the address
});
}
