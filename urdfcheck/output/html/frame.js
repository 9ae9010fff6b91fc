"use strict";
// What every page about robots does, whatever is said of them: it shows and folds the robot, paints itself, and knows where in it one is.
const frame = (() => {
const root = document.documentElement;
const by = (id) => document.getElementById(id);
const main = by("content");
const viewer = by("viewer");
const tell = (name, detail) => document.dispatchEvent(new CustomEvent(name, { detail }));
const narrow = matchMedia("(max-width: 79.99rem)");

// -- the robot --------------------------------------------------------------------------------------------------------

const fold = by("fold");
// On a telephone the findings are first, and the robot comes when it is asked for.
const small = matchMedia("(max-width: 47.99rem)").matches;

// none | coming (its room is kept) | shown | folded
function arrange(isFolded = root.dataset.viewer === "folded" || (small && root.dataset.viewer !== "shown")) {
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

fold.addEventListener("click", () => arrange(root.dataset.viewer === "shown"));
arrange();
if (viewer) {
  new MutationObserver(() => arrange()).observe(viewer, { attributes: true, attributeFilter: ["hidden"] });
  new MutationObserver(() => arrange()).observe(document.body, { attributes: true, attributeFilter: ["data-error"] });
}

// -- keys, copies, theme ----------------------------------------------------------------------------------------------

const keys = by("keys");
by("help").addEventListener("click", () => keys.showModal());
by("close-keys").addEventListener("click", () => keys.close());

// Each place can be copied as an editor takes it.
for (const place of main.querySelectorAll("code.place")) {
  const button = document.createElement("button");
  const [text] = place.title.match(/^.*:\d+(?=:\d+$)/) ?? [place.title];
  button.type = "button";
  button.className = "copy-place";
  button.title = `Copy ${text}`;
  button.setAttribute("aria-label", button.title);
  button.dataset.text = text;
  place.after(button);
}

main.addEventListener("click", ({ target }) => {
  if (target.matches(".copy-place")) copyText(target.dataset.text, target, target.dataset.text);
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
  if (section) ways.set(section.closest("details") ?? section, link);
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

// The bar is as tall as its lines: what is jumped to must not be under it.
const bar = document.querySelector(".bar");
new ResizeObserver(() => {
  const isSticky = getComputedStyle(bar).position === "sticky";
  root.style.scrollPaddingTop = isSticky ? `${bar.offsetHeight + 12}px` : "";
}).observe(bar);

// What is above a section gets its height as it is drawn, after the browser's own jump: go on until the section stays.
function arrive(section, tries = 20) {
  const before = section.getBoundingClientRect().top;
  section.scrollIntoView({ block: "start" });
  if (tries && (tries > 17 || Math.abs(section.getBoundingClientRect().top - before) > 1))
    requestAnimationFrame(() => arrive(section, tries - 1));
}

return { root, by, main, narrow, tell, reveal, arrive, keys, viewer };
})();
