// Runs in the report: selects what is at the editor's cursor, takes its theme, and says which place was clicked.

interface Selection {
  finding?: string;
  link?: string;
  joint?: string;
}

interface Model {
  id: string;
  links: { name: string }[];
  joints: { name: string }[];
}

/** Of the report: scrolls until what is above has its height. */
declare const frame: { arrive(section: Element): void };
declare function acquireVsCodeApi(): { postMessage(message: object): void };

const editor = acquireVsCodeApi();
const root = document.documentElement;
const data = document.getElementById("uc-data")?.textContent;
const models = data ? (JSON.parse(data) as { models: Model[] }).models : [];
let wanted: Selection = {};
let current: Element | null = null;

function tell(name: string, detail: object): void {
  document.dispatchEvent(new CustomEvent(name, { detail }));
}

// The page would move the focus to a card that it shows, away from the text that is typed: it is marked here instead.
function mark(card: Element | null): void {
  current?.removeAttribute("aria-current");
  current = card;
  if (!card) return;
  for (let box = card.parentElement; box; box = box.parentElement) if (box instanceof HTMLDetailsElement) box.open = true;
  card.setAttribute("aria-current", "true");
  const more = card.querySelector(".more");
  if (more instanceof HTMLDetailsElement) more.open = true;
  frame.arrive(card);
}

function select(): void {
  const { finding, link, joint } = wanted;
  const card = finding === undefined ? null : (document.getElementById(finding)?.closest(".card") ?? null);
  mark(card);
  const has = (list: { name: string }[], name: string | undefined): boolean => list.some((part) => part.name === name);
  const model = card?.closest(".model")?.id ?? models.find(({ links, joints }) => has(links, link) || has(joints, joint))?.id;
  if (model === undefined) tell("uc:clear", { origin: "editor" });
  else tell("uc:select", { model, origin: "editor", ...(card ? { finding: card.id } : { link, joint }) });
}

function paint(): void {
  const kind = document.body.dataset.vscodeThemeKind ?? "";
  root.dataset.theme = kind.includes("light") ? "light" : "dark";
}

// On a narrow page the robot waits to be asked for, and here it is.
function unfold(): void {
  if (root.dataset.viewer === "folded") document.getElementById("fold")?.click();
}

addEventListener("message", (event: MessageEvent<Selection & { type?: string }>) => {
  if (event.data.type !== "select") return;
  wanted = event.data;
  select();
});
document.addEventListener("click", ({ target }) => {
  const place = target instanceof Element ? target.closest("code.place") : null;
  if (place instanceof HTMLElement) editor.postMessage({ type: "open", place: place.title || place.textContent });
});
paint();
new MutationObserver(paint).observe(document.body, { attributeFilter: ["data-vscode-theme-kind"] });
// The robot is there a moment after its page: what was selected before is selected again.
const waiting = new MutationObserver(() => {
  waiting.disconnect();
  unfold();
  select();
});
waiting.observe(document.body, { attributeFilter: ["data-ready"] });
editor.postMessage({ type: "ready" });
