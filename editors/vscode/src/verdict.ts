// The verdict on the robot of the active editor, asked for whenever it may have changed.
import * as vscode from "vscode";
import { isRobot } from "./documents";
import type { Server } from "./server";

/** The counts of what is found in a robot, wherever it is typed; `state` differs after each check. */
export interface Verdict {
  error: number;
  warning: number;
  info: number;
  failures: string[];
  state: number;
}

export class Verdicts {
  private readonly item = vscode.window.createStatusBarItem("urdfcheck.verdict", vscode.StatusBarAlignment.Left);
  private readonly found = new vscode.EventEmitter<{ uri: vscode.Uri; verdict: Verdict }>();
  /** A robot was checked to the end. */
  readonly onVerdict = this.found.event;
  private isAsking = false;
  private isStale = false;
  private shown: string | undefined;

  constructor(private readonly server: Server) {
    this.item.name = "urdfcheck";
  }

  listen(): vscode.Disposable[] {
    const renew = (): void => { void this.renew(); };
    return [
      this.item,
      this.found,
      vscode.window.onDidChangeActiveTextEditor(renew),
      vscode.workspace.onDidChangeTextDocument(renew),
      vscode.workspace.onDidSaveTextDocument(renew),
      vscode.languages.onDidChangeDiagnostics(renew),
      this.server.onChange(renew),
    ];
  }

  /** Asks once more; what comes in meanwhile is one question after it. */
  async renew(): Promise<void> {
    if (this.isAsking) {
      this.isStale = true;
      return;
    }
    this.isAsking = true;
    do {
      this.isStale = false;
      await this.ask();
    } while (this.isStale);
    this.isAsking = false;
  }

  private async ask(): Promise<void> {
    const document = vscode.window.activeTextEditor?.document;
    if (!document) return; // a panel or the terminal has the focus: what was shown holds
    if (!isRobot(document)) {
      this.item.hide();
      this.shown = undefined;
      return;
    }
    const uri = document.uri;
    if (!this.server.isRunning) {
      this.show("$(circle-slash) urdfcheck", "urdfcheck does not run: click to look for it, or to install it", "urdfcheck.restart");
      return;
    }
    // What was said of this robot stays until there is something new to say.
    if (this.shown !== uri.toString()) this.show("$(sync~spin) urdfcheck", "urdfcheck is checking");
    const verdict = await this.server.ask<Verdict | null>("urdfcheck.awaitVerdict", uri.toString()).catch(() => null);
    if (vscode.window.activeTextEditor?.document.uri.toString() !== uri.toString()) {
      this.isStale = true;
      return;
    }
    if (!verdict) {
      this.item.hide();
      return;
    }
    this.shown = uri.toString();
    this.show(...describe(verdict));
    this.found.fire({ uri, verdict });
  }

  private show(text: string, tooltip: string, command = "urdfcheck.open3d"): void {
    Object.assign(this.item, { text, tooltip, command });
    this.item.show();
  }
}

function count(number: number, word: string): string {
  return `${number} ${word}${number === 1 ? "" : "s"}`;
}

/** The text and the tooltip of a verdict. */
export function describe({ error, warning, info, failures }: Verdict): [string, string] {
  const [failure] = failures;
  if (failure !== undefined) return ["$(alert) urdfcheck: not finished", failure];
  const notes = info ? `, ${count(info, "note")}` : "";
  const words = `${error ? count(error, "error") : "no errors"}, ${warning ? count(warning, "warning") : "no warnings"}${notes}`;
  const tooltip = `urdfcheck: ${words} in this robot and its files. Click to see it in 3D.`;
  const parts = [error ? `$(error) ${error}` : "", warning ? `$(warning) ${warning}` : ""].filter(Boolean);
  return [parts.length ? `${parts.join(" ")} urdfcheck` : "$(pass) urdfcheck", tooltip];
}
