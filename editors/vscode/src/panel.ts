// The robot in 3D beside the text: the report of the robot in the active editor, which follows the cursor.
import { readFile } from "node:fs/promises";
import * as path from "node:path";
import * as vscode from "vscode";
import { folderOf, isRobot } from "./documents";
import { makePage } from "./report";
import type { Server } from "./server";
import type { Verdicts } from "./verdict";

// Milliseconds for which the cursor rests before the robot follows it.
const REST = 150;
// What differs in the reports on equal robots.
const SECONDS = /class="seconds">[^<]*/g;

interface Selection {
  finding?: string;
  link?: string;
  joint?: string;
}

/** A robot as it was checked: the state differs after each check. */
interface State {
  uri: vscode.Uri;
  state: number;
}

type FromPage = { type: "ready" } | { type: "open"; place: string };

export class ReportPanel {
  private panel: vscode.WebviewPanel | undefined;
  private shown: vscode.Uri | undefined;
  private state = -1;
  private selection: Selection = {};
  private timer: NodeJS.Timeout | undefined;
  private isDrawing = false;
  private latest: State | undefined;
  private wanted: State | undefined;
  private text = "";

  constructor(private readonly context: vscode.ExtensionContext, private readonly server: Server, private readonly log: vscode.LogOutputChannel) {}

  listen(verdicts: Verdicts): vscode.Disposable[] {
    return [
      verdicts.onVerdict(({ uri, verdict }) => {
        this.latest = { uri, state: verdict.state };
        this.drawLatest();
      }),
      vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => { this.follow(textEditor); }),
      { dispose: () => { this.panel?.dispose(); } },
    ];
  }

  /** Shows a robot, at a card of its report or at what the cursor is at. */
  async show(uri: vscode.Uri, card?: string): Promise<void> {
    if (!this.panel) {
      const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      const options = { enableScripts: true, retainContextWhenHidden: true, enableFindWidget: true, localResourceRoots: [] };
      this.panel = vscode.window.createWebviewPanel("urdfcheck.report", "Robot in 3D", place, options);
      this.panel.webview.onDidReceiveMessage((message: FromPage) => { this.take(message); });
      this.panel.onDidChangeViewState(() => { this.drawLatest(); });
      this.panel.onDidDispose(() => {
        this.panel = this.shown = undefined;
        this.state = -1;
        this.text = "";
      });
    } else {
      this.panel.reveal(undefined, true);
    }
    const editor = vscode.window.visibleTextEditors.find(({ document }) => document.uri.toString() === uri.toString());
    this.selection = card === undefined ? await this.find(editor) : { finding: card };
    if (this.shown?.toString() === uri.toString()) this.select();
    else await this.draw(uri, this.latest?.uri.toString() === uri.toString() ? this.latest.state : -1);
  }

  /** Draws what was checked last, while somebody can see it. */
  private drawLatest(): void {
    if (this.panel?.visible && this.latest && this.shown) void this.draw(this.latest.uri, this.latest.state);
  }

  /** Draws the report unless that state of the robot is shown. Of several that are asked for meanwhile, the last one comes next. */
  private async draw(uri: vscode.Uri, state: number): Promise<void> {
    this.wanted = { uri, state };
    if (this.isDrawing) return;
    this.isDrawing = true;
    try {
      for (let next = this.takeWanted(); next; next = this.takeWanted()) await this.drawOne(next.uri, next.state);
    } catch (error) {
      this.log.error(String(error));
    } finally {
      this.isDrawing = false;
    }
  }

  private takeWanted(): State | undefined {
    const { wanted } = this;
    this.wanted = undefined;
    return wanted;
  }

  private async drawOne(uri: vscode.Uri, state: number): Promise<void> {
    if (this.shown?.toString() === uri.toString() && state === this.state) return;
    const file = await this.server.ask<string | null>("urdfcheck.writeReport", uri.toString());
    if (!file || !this.panel) return;
    const read = (name: string): Promise<string> => readFile(this.context.asAbsolutePath(`dist/${name}`), "utf8");
    const [report, script, style] = await Promise.all([readFile(file, "utf8"), read("follow.js"), read("panel.css")]);
    // Of two equal robots the first stays, as it was turned and scrolled.
    const text = report.replace(SECONDS, "");
    if (text !== this.text) this.panel.webview.html = makePage(report, script, style);
    this.text = text;
    this.panel.title = `${path.basename(uri.fsPath)} in 3D`;
    this.shown = uri;
    this.state = state;
  }

  private follow(editor: vscode.TextEditor): void {
    if (!this.panel || !vscode.workspace.getConfiguration("urdfcheck").get("follow", true)) return;
    if (editor !== vscode.window.activeTextEditor || !isRobot(editor.document)) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      void this.find(editor).then((selection) => { this.selection = selection; this.select(); });
    }, REST);
  }

  private async find(editor: vscode.TextEditor | undefined): Promise<Selection> {
    if (!editor) return {};
    const { line, character } = editor.selection.active;
    const asked = this.server.ask<Selection>("urdfcheck.findSelection", editor.document.uri.toString(), line, character);
    return (await asked.catch(() => undefined)) ?? {};
  }

  private select(): void {
    void this.panel?.webview.postMessage({ type: "select", ...this.selection });
  }

  private take(message: FromPage): void {
    if (message.type === "ready") this.select();
    else void this.open(message.place);
  }

  /** Opens `file:line:column`, as the report names places: from the folder in which the server runs. */
  private async open(place: string): Promise<void> {
    const [, name, line, column] = /^(.+?):(\d+)(?::(\d+))?$/.exec(place) ?? [];
    if (name === undefined) return;
    const file = path.resolve(folderOf()?.uri.fsPath ?? "", name);
    const at = new vscode.Position(Number(line) - 1, Math.max(0, Number(column ?? 1) - 1));
    const editors = vscode.window.visibleTextEditors.filter(({ document }) => isRobot(document));
    const selection = new vscode.Range(at, at);
    await vscode.window.showTextDocument(vscode.Uri.file(file), { selection, viewColumn: editors[0]?.viewColumn ?? vscode.ViewColumn.One });
  }
}
