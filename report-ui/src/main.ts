// The robot in 3D of urdfcheck's report.
import { Box3, Color, Vector3 } from "three";
import { inflated } from "./codec.ts";
import { Compare } from "./compare.ts";
import type { Finding, Layer, ModelData, Selection, Stage as StageData } from "./data.ts";
import { el, send } from "./dom.ts";
import { Gizmo } from "./gizmo.ts";
import { handleOf } from "./handle.ts";
import { Labels, type Anchor } from "./labels.ts";
import { Legend } from "./legend.ts";
import type { Line } from "./outline.ts";
import { filled, Overlays, stands } from "./overlays.ts";
import { JointPanel } from "./panel.ts";
import { Repair } from "./repair.ts";
import { positionOf, Robot, worse, type LinkNode, type Look } from "./robot.ts";
import { Shadow } from "./shadow.ts";
import { matrix, Shapes } from "./shapes.ts";
import { DIRECTIONS, Stage, type View } from "./stage.ts";
import { onTheme, themeOf } from "./theme.ts";
import { KEYED, Toolbar } from "./toolbar.ts";
import { Versions } from "./versions.ts";

// How much of the picture stays free around the whole robot, and around what is selected.
const ROOM = 0.1;
const CLOSE = 0.42;
// A body that an inertia in wrong units stands for is looked at up to so many sizes of the robot.
const FARTHEST = 1.5;
// Steps of the keyboard: in radians, in heights of the picture, as a factor.
const ORBIT = Math.PI / 18;
const PAN = 0.06;
const ZOOM = 1.2;

interface Shown {
  robot: Robot;
  overlays: Overlays;
  repair: Repair;
  /** Null where the model is not compared with another version. */
  versions: Versions | null;
  layers: Set<Layer>;
  offered: Set<Layer>;
}

class Viewer {
  private readonly stage: Stage;
  private readonly bar: HTMLElement;
  private readonly labels: Labels;
  private readonly panel: JointPanel;
  private readonly toolbar: Toolbar;
  private readonly gizmo = new Gizmo();
  private readonly legend: Legend;
  private readonly compare = new Compare(() => this.update());
  private readonly shadow = new Shadow();
  private readonly note = el("p", { class: "uc-note", role: "status", hidden: true });
  private readonly tip = el("div", { class: "uc-tip", hidden: true });
  private readonly scale = el("span", { class: "uc-scale" });
  private readonly print = el("img", { id: "uc-print", alt: "" });
  private readonly known = new Map<number, Shown>();
  private readonly shapes: Shapes;
  private theme;
  private shown!: Shown;
  private selection: Selection | null = null;
  private finding: Finding | null = null;
  /** Layers that the selection asks for, of its links only. */
  private asked = new Set<Layer>();
  private outlined = true;
  /** While something is selected: its glyphs only. */
  private onlySelected = true;
  private hovered: string | null = null;
  /** Whether the joints are where a selection wants them. */
  private posedForSelection = false;
  /** What is shown again, from before (0) to after (1), when what only the first version has is no longer selected. */
  private partForNext: number | null = null;

  constructor(private readonly section: HTMLElement, private readonly data: StageData, geometry: Uint8Array) {
    const part = (name: string) => section.querySelector<HTMLElement>(`.uc-${name}`)!;
    const view = part("view");
    this.stage = new Stage(view);
    performance.mark("uc-stage");
    this.bar = part("bar");
    this.theme = themeOf(section);
    this.shapes = new Shapes(data.meshes, geometry);
    this.labels = new Labels(part("labels"));
    this.panel = new JointPanel(part("joints") as HTMLDetailsElement, () => this.posed());
    this.toolbar = new Toolbar(this.bar, data.models.map((model) => model.name), {
      layer: (layer) => this.toggle(layer),
      outline: () => { this.outlined = !this.outlined; this.update(); },
      only: () => { this.onlySelected = !this.onlySelected; this.update(); },
      view: (name) => this.look(name),
      parallel: () => { this.stage.project(!this.stage.parallel); this.update(); },
      home: () => this.home(),
      picture: () => this.save(),
      full: () => void (document.fullscreenElement ? document.exitFullscreen() : section.requestFullscreen()),
      model: (index) => { send("uc:clear", { origin: "viewer" }); this.open(index); },
    });
    this.bar.append(this.note);
    part("corner").append(this.gizmo.element, this.scale);
    this.legend = new Legend(view.clientWidth);
    view.append(el("div", { class: "uc-foot" }, this.compare.element, this.legend.element), this.tip);
    section.append(this.print);
    this.stage.onRender = () => {
      const { width, height } = this.stage.bounds;
      this.labels.place(this.stage.camera, width, height, this.stage.inset);
      this.gizmo.turn(this.stage.camera);
    };
    this.stage.onResize = () => {
      if (!this.stage.touched) this.arrive(true);
    };
    this.stage.scene.add(this.shadow.mesh);
    this.stage.paint(this.theme);
    this.open(0);
    this.listen();
  }

  private get robot(): Robot {
    return this.shown.robot;
  }

  private get model(): ModelData {
    return this.robot.data;
  }

  /** The bounds of all that is drawn. */
  private get box(): Box3 {
    const { robot, versions } = this.shown;
    return versions ? robot.box.clone().union(versions.before.box) : robot.box;
  }

  // -- what is shown --

  private open(index: number): void {
    if (this.shown) {
      this.turn(false);
      this.shown.repair.show(null);
      this.shown.robot.root.removeFromParent();
      this.shown.versions?.before.root.removeFromParent();
      this.shown.versions?.ways.removeFromParent();
    }
    let shown = this.known.get(index);
    if (!shown) {
      const data = this.data.models[index]!;
      const robot = new Robot(data, this.shapes);
      const versions = data.before ? new Versions(robot, data.before, this.shapes) : null;
      const offered = new Set([...filled(robot, this.shapes), ...(versions?.offered ?? [])]);
      const layers = new Set<Layer>(offered.has("visual") ? ["visual"] : offered.has("collision") ? ["collision"] : data.joints.length ? [] : ["frames"]);
      shown = { robot, overlays: new Overlays(robot, this.shapes), repair: new Repair(robot), versions, layers, offered };
      this.known.set(index, shown);
    }
    this.shown = shown;
    this.stage.scene.add(this.robot.root);
    if (shown.versions) this.stage.scene.add(shown.versions.before.root, shown.versions.ways);
    const { data } = this.robot;
    this.stage.fit(this.box, this.robot.ground, this.theme);
    this.scale.textContent = `grid ${this.stage.cell}`;
    this.note.textContent = data.undrawn;
    this.note.hidden = !data.undrawn;
    this.stage.canvas.setAttribute(
      "aria-label",
      `${data.name} in 3D. Arrow keys orbit, with Shift they move; plus and minus zoom; h shows the whole robot. The findings say the same in words.`,
    );
    this.print.alt = `${data.name}, as it stands with every joint at its start`;
    const severities = [...this.robot.links.values()].map((link) => this.robot.severityOf(link));
    this.toolbar.offer(shown.offered, !shown.versions && (severities.includes("error") || severities.includes("warning")), stands(data));
    if (this.toolbar.models) this.toolbar.models.selectedIndex = index;
    this.panel.show(this.robot);
    this.cast();
    this.update();
    performance.mark("uc-built");
    this.home(true);
  }

  /** The links that the selection is about. */
  private get subjects(): Set<string> | null {
    if (!this.selection) return null;
    const { link, joint } = this.selection;
    const { finding: shown } = this;
    const links = shown
      ? this.linksOf(shown.links, shown.joints)
      : this.linksOf(link === undefined ? [] : [link], joint === undefined ? [] : [joint]);
    for (const { finding, a, b } of this.model.overlaps) {
      if (shown && finding === shown.id) links.add(a).add(b);
    }
    return links.size ? links : null;
  }

  /** What the selected finding compares its subjects with. */
  private get beside(): Set<string> {
    const { beside } = this.finding ?? {};
    return beside ? this.linksOf(beside.links, beside.joints) : new Set();
  }

  /** Links, and those that joints hold. */
  private linksOf(links: string[], joints: string[]): Set<string> {
    const children = joints.map((name) => this.robot.joints.get(name)?.data.child);
    return new Set([...links, ...children].filter((name): name is string => Boolean(name)));
  }

  /** What should be in view: of what the subjects are compared with no more than there are of them. */
  private get inView(): Set<string> | null {
    const { subjects, beside } = this;
    return subjects && beside.size <= subjects.size ? new Set([...subjects, ...beside]) : subjects;
  }

  /** The same links as the first of two versions calls them; null where none are named, or all of the robot is shown. */
  private get subjectsBefore(): Set<string> | null {
    const { versions } = this.shown;
    if (!versions || !this.selection) return null;
    if (this.finding?.whole) return null;
    const own = this.finding?.before?.filter(Boolean) ?? [...(this.subjects ?? [])].map((name) => versions.nameBefore(name));
    return own.length || this.subjects ? new Set(own) : null;
  }

  /** Those that stay solid: the subjects, and what a joint hangs on where that helps to see it. */
  private lit(subjects: Set<string> | null): Set<string> | null {
    // How far a part moves is seen beside all that does not.
    if (this.finding?.whole) return null;
    // What is only in the first version stands out from all of the second.
    if (!subjects) return this.subjectsBefore ? new Set() : null;
    const lit = new Set([...subjects, ...this.beside]);
    for (const name of subjects) {
      const node = this.robot.links.get(name);
      const ofJoint = !this.finding && this.selection?.joint !== undefined;
      if (node?.parent && (ofJoint || (this.finding?.joints.length && node.box.isEmpty()))) lit.add(node.parent.data.parent);
    }
    return lit;
  }

  private update(): void {
    const { robot, layers, repair, versions } = this.shown;
    const subjects = this.subjects;
    const visual = layers.has("visual") || this.asked.has("visual");
    const collision = layers.has("collision") || this.asked.has("collision");
    const look: Look = {
      visual,
      // Of two versions those of the one that is chosen.
      collision: collision && (versions?.isAfter ?? true),
      lit: this.lit(subjects),
      sheer: collision && this.finding?.inside === true,
      // Two versions and a repair have lines of their own, and after a repair there is nothing to warn of.
      outline: (name, own) => {
        if (!this.outlined || versions || repair.frames.size) return "";
        if (repair.isAfter) return repair.inertias.has(name) ? "other" : "";
        return !this.finding || !subjects ? own : subjects.has(name) ? this.finding.severity : "";
      },
      hovered: this.hovered,
    };
    const outlined = robot.dress(look, this.theme);
    if (visual) outlined.push(...repair.outlined);
    const litBefore = this.subjectsBefore;
    versions?.dress(outlined, { ...look, collision }, litBefore, this.theme);
    this.stage.outline.show(outlined);
    robot.root.updateMatrixWorld(true);
    this.shadow.show(visual, this.theme.dark, look.lit !== null);
    const isBefore = versions !== null && !versions.isAfter;
    const [overlays, others] = isBefore ? [versions.overlays, this.shown.overlays] : [this.shown.overlays, versions?.overlays];
    others?.show(new Set(), new Set(), null, false, repair);
    const shownOf = subjects && new Set([...subjects, ...this.beside]);
    const anchors = overlays.show(layers, this.asked, isBefore ? litBefore : shownOf, this.onlySelected, repair, this.finding?.id)
      .concat(repair.anchors, versions?.anchors ?? []);
    this.labels.set(anchors.concat(this.names(this.inView, anchors)));
    const on = new Set([...layers, ...this.asked]);
    this.toolbar.show(on, this.outlined, this.onlySelected, this.stage.parallel, look.lit !== null);
    this.compare.show(versions ?? repair);
    const lines = new Set(outlined.map(({ line }) => line).filter((line): line is Line => line !== null));
    const { drawn } = overlays;
    this.legend.show({
      ...drawn, layers: on.has("collision") ? drawn.layers.add("collision") : drawn.layers, lines, repair, stands: stands((isBefore ? versions.before : robot).data), versions: versions !== null,
    });
    this.stage.request();
  }

  /** The names of the selected links, if no label says them already. */
  private names(subjects: Set<string> | null, others: Anchor[]): Anchor[] {
    if (!subjects || subjects.size > 6) return [];
    const said = new Set(others.map((anchor) => anchor.about ?? (anchor.kind === "link" ? anchor.text : "")));
    return [...subjects].flatMap((name) => {
      const link = this.robot.links.get(name);
      return link && !said.has(name) && !this.shown.repair.inertias.has(name) ? [{ text: name, object: link.frame, kind: "link" as const, rank: 5 }] : [];
    });
  }

  private cast(): void {
    this.robot.root.updateMatrixWorld(true);
    this.shadow.cast(this.robot, this.robot.ground);
  }

  private posed(): void {
    this.cast();
    const { repair, versions } = this.shown;
    versions?.pose();
    versions?.trace(this.finding);
    if (repair.shown) {
      const { isAfter } = repair;
      this.suggest();
      repair.place(isAfter ? 1 : 0);
    }
    this.update();
  }

  /** Puts the joints where a change is seen best, or back. */
  private assume(pose: Record<string, number> | undefined): void {
    if (!pose && !this.posedForSelection) return;
    for (const joint of this.robot.movable) this.robot.set(joint.data.name, pose?.[joint.data.name] ?? joint.data.start);
    this.posedForSelection = pose !== undefined;
    this.panel.refresh(true);
    this.posed();
  }

  /** Chooses the first of two versions for what only that has, or takes this back. */
  private turn(isGone: boolean): void {
    const { versions } = this.shown;
    if (!versions || (!isGone && this.partForNext === null)) return;
    this.compare.stop();
    const kept = this.partForNext ?? versions.part;
    this.partForNext = isGone ? kept : null;
    versions.place(isGone ? 0 : kept);
  }

  private suggest(): Vector3[] {
    this.compare.stop();
    this.shown.versions?.trace(this.finding);
    return this.shown.repair.show(this.finding);
  }

  private toggle(layer: Layer): void {
    if (!this.shown.offered.has(layer)) return;
    const { layers } = this.shown;
    if (this.asked.delete(layer) || layers.has(layer)) layers.delete(layer);
    else layers.add(layer);
    this.update();
  }

  // -- the camera --

  private look(name: string): void {
    const { inView } = this;
    const box = inView ? this.boundsOf(inView, []) : this.box;
    this.stage.touched = false;
    this.aim = () => this.stage.around(box, new Vector3(...DIRECTIONS[name]), inView ? CLOSE : ROOM);
    this.arrive();
  }

  private home(atOnce = false): void {
    this.stage.touched = false;
    this.aim = () => this.stage.around(this.box, new Vector3(...DIRECTIONS.iso), ROOM);
    this.arrive(atOnce);
  }

  /** Where the camera was sent last; a change of the window's size sends it there again. */
  private aim: (() => View) | null = null;

  private arrive(atOnce = false): void {
    if (!this.aim) return;
    // On a low picture the buttons may lie over the robot.
    this.stage.inset = Math.min(this.bar.offsetTop + this.bar.offsetHeight, 0.3 * this.stage.bounds.height);
    this.stage.fly(this.aim(), atOnce);
  }

  /** The bounds of all that is drawn, as the joints are now. */
  private boundsNow(): Box3 {
    const { robot, versions } = this.shown;
    const box = new Box3();
    for (const drawn of versions ? [robot, versions.before] : [robot]) {
      for (const link of drawn.links.values()) box.union(drawn.boundsOf(link)).expandByPoint(positionOf(link.frame));
    }
    return box;
  }

  /** The bounds of links; those without shapes count as big as their glyphs. The body that an inertia stands for counts where
   * it is looked at. */
  private boundsOf(names: Iterable<string>, points: Vector3[]): Box3 {
    const box = new Box3().setFromPoints(points);
    const isOn = (layer: Layer) => this.shown.layers.has(layer) || this.asked.has(layer);
    const withInertia = isOn("box");
    const withFrames = isOn("axes") || isOn("frames");
    this.robot.root.updateMatrixWorld(true);
    for (const name of names) {
      const link = this.robot.links.get(name);
      if (!link) continue;
      const own = this.robot.boundsOf(link);
      const reach = 1.6 * this.robot.unit(link);
      if (own.isEmpty()) own.setFromCenterAndSize(positionOf(link.frame), new Vector3(reach, reach, reach));
      // Its name and its axes are at its frame, which may be beside its shapes.
      const frame = new Box3().setFromCenterAndSize(positionOf(link.frame), new Vector3().setScalar(withFrames ? 1.2 * reach : 0));
      const away = own.distanceToPoint(positionOf(link.frame));
      if (away < own.getSize(new Vector3()).length()) own.union(frame);
      box.union(own);
      const { inertia } = link.data;
      if (withInertia && inertia && "box" in inertia) {
        const [x, y, z] = inertia.box.map((edge) => Math.min(edge, FARTHEST * this.robot.size) / 2);
        const body = new Box3(new Vector3(-x, -y, -z), new Vector3(x, y, z));
        box.union(body.applyMatrix4(matrix(inertia.at)).applyMatrix4(link.frame.matrixWorld));
      }
    }
    for (const name of this.subjectsBefore ?? []) {
      const { before } = this.shown.versions!;
      const link = before.links.get(name);
      if (link) box.union(before.boundsOf(link)).expandByPoint(positionOf(link.frame));
    }
    // However small a link is, what is around it helps to tell where it is.
    const small = 0.05 * this.robot.size;
    const middle = box.getCenter(new Vector3());
    return box.union(new Box3().setFromCenterAndSize(middle, new Vector3(small, small, small)));
  }

  // -- the selection --

  private select(selection: Selection): void {
    const index = this.data.models.findIndex((model) => model.id === selection.model);
    if (index < 0) return;
    if (this.model.id !== selection.model) this.open(index);
    this.selection = selection;
    this.finding = selection.finding === undefined
      ? null
      : this.model.findings.find((finding) => finding.id === selection.finding) ?? null;
    const { offered, layers } = this.shown;
    const asked: Layer[] = this.finding?.layers ?? (selection.joint !== undefined ? ["axes", "frames"] : ["frames"]);
    // The overlaps are those at the start.
    const isElsewhere = this.finding?.pose !== undefined;
    this.asked = new Set(asked.filter((layer) => offered.has(layer) && !layers.has(layer) && !(isElsewhere && layer === "overlaps")));
    this.turn(this.finding?.gone === true);
    this.assume(this.finding?.pose);
    const points = this.suggest();
    const subjects = [...(this.subjects ?? [])];
    // Where nothing of it can be seen, its frame is shown.
    if (subjects.length && subjects.every((name) => this.robot.links.get(name)?.box.isEmpty())) this.asked.add("frames");
    document.body.dataset.selected = subjects[0] ?? "";
    this.update();
    if (!subjects.length && !points.length && !this.subjectsBefore) return this.home();
    const { direction } = this.stage.view();
    // From below or straight above little can be told.
    const level = Math.max(0.22, Math.min(0.72, direction.z));
    const flat = Math.hypot(direction.x, direction.y) || 1;
    const side = Math.sqrt(1 - level * level) / flat;
    const from = new Vector3(direction.x * side, direction.y * side, level);
    const isWhole = this.finding?.whole === true;
    const box = isWhole ? this.boundsNow() : this.boundsOf(this.inView ?? [], points);
    this.stage.touched = false;
    this.aim = () => this.stage.around(box, from, isWhole ? ROOM : CLOSE);
    this.arrive();
  }

  private clear(): void {
    if (!this.selection) return;
    this.selection = null;
    this.finding = null;
    this.asked.clear();
    this.turn(false);
    this.assume(undefined);
    this.suggest();
    document.body.dataset.selected = "";
    this.update();
    // Back from where it was sent, but not from where a person went.
    if (!this.stage.touched) this.home();
  }

  // -- what people and the page do --

  private listen(): void {
    const { canvas } = this.stage;
    document.addEventListener("uc:select", (event) => this.select((event as CustomEvent<Selection>).detail));
    document.addEventListener("uc:clear", () => this.clear());
    onTheme(() => this.recolour());
    addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("keydown", (event) => this.steer(event));

    let down = [0, 0];
    let busy = false;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; busy = true; this.hover(null); });
    addEventListener("pointerup", () => { busy = false; });
    canvas.addEventListener("click", ({ clientX, clientY }) => {
      if (Math.hypot(clientX - down[0], clientY - down[1]) > 5) return;
      const link = this.under(clientX, clientY);
      if (link !== null) send("uc:select", { model: this.model.id, link, origin: "viewer" });
      else if (this.selection) send("uc:clear", { origin: "viewer" });
    });
    let waiting = 0;
    canvas.addEventListener("pointermove", ({ clientX, clientY, pointerType }) => {
      if (busy || pointerType === "touch" || waiting) return;
      waiting = requestAnimationFrame(() => {
        waiting = 0;
        if (!busy) this.hover(this.under(clientX, clientY), clientX, clientY);
      });
    });
    canvas.addEventListener("pointerleave", () => this.hover(null));
    addEventListener("beforeprint", () => this.photograph());
    this.stage.onLost(() => fail("The browser took the graphics away. Reload the page to see the robot in 3D.", this.section));
  }

  private under(x: number, y: number): string | null {
    return this.stage.pick(x, y, this.robot.targets);
  }

  private hover(name: string | null, x = 0, y = 0): void {
    const link = name === null ? null : this.robot.links.get(name)!;
    this.tip.hidden = !link;
    this.stage.canvas.style.cursor = link ? "pointer" : "";
    if (link) {
      this.tip.replaceChildren(el("b", {}, link.data.name), ...this.worst(link));
      const rect = this.stage.canvas.getBoundingClientRect();
      const left = Math.min(x - rect.left + 14, rect.width - this.tip.offsetWidth - 8);
      this.tip.style.transform = `translate(${Math.round(left)}px, ${Math.round(y - rect.top + 16)}px)`;
    }
    if (name === this.hovered) return;
    this.hovered = name;
    this.update();
  }

  /** The worst finding of a link and of the joint that places it, in words. */
  private worst(link: LinkNode): HTMLElement[] {
    const joint = link.parent?.data.name;
    const { findings } = this.model;
    const isIn = ({ links, joints }: { links: string[]; joints: string[] }) =>
      links.includes(link.data.name) || (joint !== undefined && joints.includes(joint));
    const own = findings.filter(isIn);
    const others = findings.filter((finding) => !own.includes(finding) && finding.beside && isIn(finding.beside));
    const told = own.length ? own : others;
    if (!told.length) return [el("span", {}, this.shown.versions ? "no change" : "no findings")];
    const worst = told.reduce((a, b) => (worse(a.severity, b.severity) === a.severity ? a : b));
    const count = own.length + others.length;
    const more = count > 1 ? ` and ${count - 1} more` : "";
    // What is right, and another part is compared with, has no defect of its own.
    return [el("span", { class: own.length ? worst.severity : "" }, `${own.length ? "" : "compared in "}${worst.severity} ${worst.code}${more}`)];
  }

  private key(event: KeyboardEvent): void {
    const typing = (event.target as Element).closest?.("input, select, textarea, [contenteditable]");
    if (typing || event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const layer = /^\d$/.test(event.key) ? KEYED[(Number(event.key) + 9) % 10] : undefined;
    if (event.key === "h") this.home();
    else if (event.key === "b") this.compare.peek(true);
    else if (layer) this.toggle(layer);
    else return;
    event.preventDefault();
  }

  /** Keys of the picture while it has the focus: the page has the same ones to scroll. */
  private steer(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { key, shiftKey } = event;
    const across = Number(key === "ArrowRight") - Number(key === "ArrowLeft");
    const up = Number(key === "ArrowUp") - Number(key === "ArrowDown");
    const nearer = Number(key === "+" || key === "=") - Number(key === "-" || key === "_");
    if (nearer) this.stage.zoom(ZOOM ** -nearer);
    else if (!across && !up) return;
    else if (shiftKey) this.stage.pan(across * PAN, up * PAN);
    else this.stage.orbit(across * ORBIT, up * ORBIT);
    event.preventDefault();
  }

  private recolour(): void {
    this.theme = themeOf(this.section);
    this.stage.paint(this.theme);
    this.cast();
    this.update();
  }

  private save(): void {
    el("a", { href: this.stage.picture(), download: `${this.model.name}.png` }).click();
  }

  /** What a printer gets, on white. */
  photograph(): void {
    this.print.src = this.stage.picture(new Color(1, 1, 1));
  }

  get handle(): object {
    return handleOf(this.stage, () => this.robot, () => this.shown.versions, () => { this.panel.refresh(); this.posed(); });
  }
}

function fail(reason: string, section: HTMLElement | null): void {
  if (section) section.hidden = true;
  const line = document.getElementById("no-viewer");
  if (line) {
    line.textContent = reason;
    line.hidden = false;
  }
  document.body.dataset.error = reason;
}

async function start(): Promise<void> {
  const section = document.getElementById("viewer");
  if (!section) return;
  try {
    const text = (id: string) => document.getElementById(id)?.textContent ?? "";
    const data = JSON.parse(text("uc-data")) as StageData;
    const geometry = await inflated(text("uc-geom"));
    performance.mark("uc-inflated");
    section.hidden = false;
    // The page makes room before anything is measured.
    await null;
    const viewer = new Viewer(section, data, geometry);
    performance.mark("uc-ready");
    Object.assign(window, { urdfcheck: viewer.handle });
    document.body.dataset.ready = "1";
    (window.requestIdleCallback ?? setTimeout)(() => viewer.photograph());
  } catch (error) {
    fail(`The robot cannot be shown in 3D: ${error instanceof Error ? error.message : error}.`, section);
  }
}

void start();
