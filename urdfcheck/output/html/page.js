"use strict";
// Searches, filters, groups, chooses and copies. All that it shows is in the page: it moves and hides elements, and what it
// writes of a file goes through textContent.
{
const { root, by, main, narrow, tell, reveal, arrive, keys, viewer } = frame;

// -- the findings -----------------------------------------------------------------------------------------------------

const elementOf = ({ dataset }) =>
  dataset.link !== undefined ? `link ${dataset.link}` : dataset.joint !== undefined ? `joint ${dataset.joint}` : "";

// The links and joints that the 3D view shows for a finding are more than its subjects.
const staged = new Map();
for (const { findings } of JSON.parse(by("uc-data")?.textContent ?? '{"models": []}').models) {
  for (const { id, links, joints, beside } of findings) {
    const shown = [{ links, joints }, beside ?? { links: [], joints: [] }];
    staged.set(id, shown.flatMap((each) => [...each.links.map((name) => `link ${name}`), ...each.joints.map((name) => `joint ${name}`)]));
  }
}

const findings = Array.from(main.querySelectorAll(".card"), (card) => {
  const subjects = card.querySelector(".subjects");
  const own = Array.from(subjects?.parentElement.querySelectorAll(".subjects li") ?? [], elementOf);
  const elements = [...own, ...(staged.get(card.id) ?? [])];
  const named = card.querySelector(".rule-name").textContent.trim();
  // As the card shows them, and whole: a place that is a line of the same file has no name of its own.
  const places = Array.from(card.querySelectorAll(":is(.at, .occurrences) .place"), (place) => `${place.textContent} ${place.title}`);
  const text = [card.querySelector("h4").textContent, named, card.querySelector(".message").textContent, subjects?.textContent, card.dataset.file, ...places];
  return {
    card,
    home: card.parentElement,
    model: card.closest(".model"),
    severity: ["error", "warning", "info"].find((severity) => card.classList.contains(severity)),
    known: card.classList.contains("known"),
    code: card.dataset.code,
    confidence: card.dataset.confidence,
    elements: [...new Set(elements)].filter(Boolean),
    // Those it is filed under.
    own: [...new Set(own)].filter(Boolean),
    programs: card.dataset.programs?.split(" ") ?? [],
    text: text.join(" ").toLowerCase(),
    rule: named,
    shown: true,
  };
});
// What is no link but is seen at one, such as a transform, is shown in 3D too.
for (const { card } of findings) {
  const line = card.querySelector(".at");
  if (!line || !staged.get(card.id)?.length || line.querySelector(":scope > .in-3d")) continue;
  const button = document.createElement("button");
  button.type = "button";
  button.className = "in-3d";
  button.title = "Show in 3D";
  button.setAttribute("aria-label", button.title);
  button.textContent = "3D";
  button.hidden = true;
  line.append(button);
}
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
// The program whose chip is pressed, as {model, name, label}.
let program = null;
const opened = new Set();
// Groups that the page's script made, and in them the lines that lead to cards in other ones.
let made = [];
let stubs = [];

function fill(select, options) {
  for (const [value, label] of [...options].sort(([a], [b]) => a.localeCompare(b, "en", { numeric: true }))) {
    select.add(new Option(label, value));
  }
}
const counted = (finding) => !finding.known || Boolean(withKnown?.checked);
fill(rule, new Map(findings.map(({ code, rule }) => [code, rule])));
fill(element, new Map(findings.flatMap(({ elements }) => elements.map((name) => [name, name]))));
fill(confidence, new Map(findings.map(({ confidence }) => [confidence, confidence])));

// -- the strip of programs: links to the table, and here filters

const chips = Array.from(document.querySelectorAll(".programs a"), (link) => {
  const button = document.createElement("button");
  button.type = "button";
  button.className = link.className;
  button.title = link.title;
  button.setAttribute("aria-pressed", "false");
  button.append(...link.childNodes);
  link.replaceWith(button);
  const name = link.dataset.program;
  const { model } = button.closest(".programs").dataset;
  button.addEventListener("click", () => {
    const isOn = program?.name === name && program.model === model;
    program = isOn ? null : { model, name, isUnlisted: "unlisted" in link.dataset, label: link.title.slice(0, -button.querySelector(".sr").textContent.length) };
    search(!isOn);
  });
  return { button, model, name };
});

function filter() {
  const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
  const off = Array.from(tiles).flatMap((box) => (box.checked ? [] : [box.id.replace("show-", "")]));
  const isActive = Boolean(words.length || off.length || rule.value || element.value || confidence.value || picked || program);
  let total = 0;
  let count = 0;
  const kept = new Map();
  for (const finding of findings) {
    // A suppressed finding is a reason for what a program does, too.
    const isCounted = counted(finding) || Boolean(program);
    finding.shown =
      (!isCounted && !isActive) ||
      (isCounted &&
        !off.includes(finding.severity) &&
        (!rule.value || finding.code === rule.value) &&
        (!confidence.value || finding.confidence === confidence.value) &&
        (!element.value || finding.elements.includes(element.value)) &&
        (!picked || (finding.model.id === picked.model && finding.elements.includes(picked.name))) &&
        (!program || (finding.model.id === program.model && finding.programs.includes(program.name))) &&
        words.every((word) => finding.text.includes(word)));
    total += isCounted;
    count += isCounted && finding.shown;
    if (finding.card.hidden === finding.shown) finding.card.hidden = !finding.shown;
    if (!finding.shown) continue;
    for (let box = finding.card.parentElement; box !== main; box = box.parentElement) kept.set(box, (kept.get(box) ?? 0) + 1);
  }
  for (const { stub, of } of stubs) {
    stub.hidden = !of.shown;
    const box = stub.closest(".group");
    if (of.shown) kept.set(box, (kept.get(box) ?? 0) + 1);
  }
  for (const box of main.querySelectorAll(".model, .group, .fold")) {
    const number = kept.get(box) ?? 0;
    // A model without findings is on the page still, unless something is searched for.
    box.hidden = !number && (isActive || !box.matches(".model"));
    if (box.tagName !== "DETAILS") continue;
    // What is searched for must not stay in a fold.
    if (isActive && number && !box.open) {
      box.open = true;
      opened.add(box);
    } else if (!isActive && opened.delete(box)) {
      box.open = false;
    }
  }
  // One flat list: the tables and all else are out of the way meanwhile.
  main.toggleAttribute("data-filtered", isActive);
  const nothing = by("nothing");
  // What is listed is not the worst that the program does.
  const isUnasked = Boolean(program?.isUnlisted);
  nothing.hidden = !isActive || (count > 0 && !isUnasked);
  if (isUnasked) nothing.textContent = `Why ${program.label} minds is in notes that only -v reports; the table "In each program" names the rules.`;
  else nothing.textContent = nothing.hidden ? "" : `No finding matches ${find.value.trim() ? `"${find.value.trim()}"` : "these filters"}.`;
  for (const { button, model, name } of chips)
    button.setAttribute("aria-pressed", String(program?.name === name && program.model === model));
  state.hidden = !isActive && back.hidden;
  by("reset").hidden = !isActive;
  by("shown").textContent = isActive ? `${count} of ${total} shown` : "";
  chip.hidden = !picked && !program;
  if (!chip.hidden) chip.textContent = `${[picked?.name, program?.label].filter(Boolean).join(", ")} \u00d7`;
}

function reset() {
  find.value = rule.value = element.value = confidence.value = "";
  for (const box of tiles) box.checked = true;
  unpick();
}

function unpick() {
  picked = program = null;
  filter();
}

// What is found must not be out of sight.
function search(isAsked = Boolean(find.value)) {
  filter();
  const first = isAsked && findings.find(({ shown, known }) => shown && !known)?.card;
  if (!first) return;
  const { top, bottom } = first.getBoundingClientRect();
  if (bottom < 0 || top > innerHeight) first.scrollIntoView({ block: "start" });
}

let waiting = 0;
find.addEventListener("input", () => {
  clearTimeout(waiting);
  waiting = setTimeout(() => search(), findings.length > 300 ? 120 : 0);
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
  element: (finding) => finding.own[0] ?? finding.elements[0] ?? WHOLE,
  file: ({ card }) => card.dataset.file || WHOLE,
};
function refer(of, name) {
  const stub = document.createElement("p");
  const link = document.createElement("a");
  stub.className = "stub";
  link.href = `#${of.card.id}`;
  link.textContent = `${of.code} ${of.card.querySelector(".headline").textContent}`;
  stub.append(of.card.querySelector(".glyph").cloneNode(true), " ", link, `, under ${name}`);
  return { stub, of };
}

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
    if (group.value !== "element") continue;
    // A card is in one place: the other elements that have the defect lead there.
    for (const other of finding.own.slice(1)) places.set(other, [...(places.get(other) ?? []), refer(finding, name)]);
  }
  for (const box of made) box.remove();
  made = [];
  stubs = [];
  for (const [model, places] of groups) {
    const into = model.querySelector(".findings");
    const before = into.querySelector(":scope > .fold");
    for (const [name, cards] of [...places].sort(([a], [b]) => (a === WHOLE) - (b === WHOLE))) {
      const box = document.createElement("section");
      const head = document.createElement("h3");
      const count = document.createElement("span");
      const list = document.createElement("div");
      box.className = "group made";
      count.className = "count";
      count.textContent = cards.length;
      list.className = "cards";
      const first = cards[0].of ?? ofCard.get(cards[0]);
      head.append(first.card.querySelector(".glyph").cloneNode(true), ` ${name} `, count);
      head.classList.add(first.severity);
      for (const entry of cards) if (entry.of) stubs.push(entry);
      cards.sort((a, b) => Boolean(a.of) - Boolean(b.of));
      list.append(...cards.map((entry) => entry.stub ?? entry));
      box.append(head, list);
      into.insertBefore(box, before);
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

back.addEventListener("click", () => {
  if (current) choose(current, { scroll: true });
});
// What was chosen before there was a robot to show it.
if (viewer) new MutationObserver(show).observe(document.body, { attributes: true, attributeFilter: ["data-ready"] });

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
  // Where the robot is above them it stays in sight.
  const first = picked && findings.find(({ shown, known }) => shown && !known)?.card;
  if (first && !narrow.matches) first.scrollIntoView({ block: "start" });
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
    const more = card.querySelector(".more");
    if (!target.closest(".more, .frame")) more.open = !more.open;
    choose(ofCard.get(card));
    address(current);
  }
});

// -- keys, copies, theme ----------------------------------------------------------------------------------------------

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

main.addEventListener("click", ({ target }) => {
  if (target.matches(".copy-diff")) copyText(target.closest(".fix").querySelector(".diff").textContent, target, "The diff");
  if (target.matches(".copy-link")) {
    const { href, hash } = location;
    copyText(`${href.slice(0, href.length - hash.length)}#${target.closest(".card").id}`, target, "The link");
  }
});

follow();

function arriveAtAddress() {
  const target = by(location.hash.slice(1));
  if (!target || target.closest(".card")) return;
  if (main.hasAttribute("data-filtered")) reset();
  const fold = target.closest("details");
  if (fold) fold.open = true;
  arrive(fold ?? target);
}
addEventListener("load", arriveAtAddress);
addEventListener("hashchange", arriveAtAddress);
document.addEventListener("click", ({ target }) => {
  const link = target.closest('a[href^="#"]');
  if (link && link.hash === location.hash) arriveAtAddress(); // no change of the address
});
}
