// The server: started when the first robot is open, asked by everything else.
import * as vscode from "vscode";
import { ExecuteCommandRequest, LanguageClient, type LanguageClientOptions } from "vscode-languageclient/node";
import { folderOf } from "./documents";
import type { Programs } from "./program";

// What the server reads unsaved: robots and what they are made of.
const SELECTOR = [
  { scheme: "file", language: "xml" },
  { scheme: "file", language: "yaml" },
  { scheme: "file", pattern: "**/*.{urdf,xacro,srdf,launch}" },
  { scheme: "file", pattern: "**/*{.launch,_launch}.py" },
];

export type Command = (uri: string, card?: string) => Promise<void>;

export class Server {
  private client: LanguageClient | undefined;
  private starting: Promise<LanguageClient | undefined> | undefined;
  private isRefused = false;
  private readonly changed = new vscode.EventEmitter<boolean>();
  /** Whether there is a server now. */
  readonly onChange = this.changed.event;

  /** Shows the report here instead of in a browser. */
  showReport: Command | undefined;

  constructor(private readonly programs: Programs, private readonly log: vscode.LogOutputChannel) {}

  get isRunning(): boolean {
    return this.client !== undefined;
  }

  /** Starts the server unless it runs; undefined where it cannot be had. `asks`: again, if that was declined before. */
  start(asks = false): Promise<LanguageClient | undefined> {
    if (asks) this.isRefused = false;
    this.starting ??= this.launch().finally(() => { this.starting = undefined; });
    return this.starting;
  }

  /** Starts the server again, of the program that is there now. */
  async restart(): Promise<void> {
    await this.stop();
    await this.programs.find(true);
    await this.start(true);
  }

  async stop(): Promise<void> {
    const client = this.client;
    this.client = undefined;
    this.changed.fire(false);
    await client?.stop().catch((error: unknown) => { this.log.warn(String(error)); });
  }

  /** Asks for a command of the server; undefined where there is no server. */
  async ask<T>(command: string, ...words: unknown[]): Promise<T | undefined> {
    const client = await this.start();
    return client && ((await client.sendRequest(ExecuteCommandRequest.type, { command, arguments: words })) as T);
  }

  /** The program; offers to install it where it is missing. */
  async findProgram(): Promise<string | undefined> {
    const program = await this.programs.find();
    if (program || this.isRefused) return program;
    const answer = await vscode.window.showInformationMessage(
      "urdfcheck was not found. It can be installed with pip into an environment that only this extension uses.",
      "Install",
      "Name the program",
    );
    if (answer === "Install" && (await this.programs.install())) return this.programs.find(true);
    if (answer === "Name the program") await vscode.commands.executeCommand("workbench.action.openSettings", "urdfcheck.path");
    this.isRefused = true;
    return undefined;
  }

  private async launch(): Promise<LanguageClient | undefined> {
    if (this.client) return this.client;
    const command = await this.findProgram();
    if (!command) return undefined;
    const words = vscode.workspace.getConfiguration("urdfcheck").get<string[]>("arguments", []);
    const cwd = folderOf()?.uri.fsPath;
    const options: LanguageClientOptions = {
      documentSelector: SELECTOR,
      outputChannel: this.log,
      middleware: {
        executeCommand: (name, given, next) => {
          const [uri, card] = given as string[];
          if (name === "urdfcheck.showReport" && this.showReport && uri !== undefined) return this.showReport(uri, card);
          return next(name, given) as unknown;
        },
      },
    };
    const program = { command, args: ["server", ...words], ...(cwd === undefined ? {} : { options: { cwd } }) };
    const client = new LanguageClient("urdfcheck", "urdfcheck", program, options);
    try {
      await client.start();
    } catch (error) {
      await this.programs.offerLog(`urdfcheck server did not start: ${String(error)}`);
      return undefined;
    }
    this.client = client;
    this.changed.fire(true);
    return client;
  }
}
