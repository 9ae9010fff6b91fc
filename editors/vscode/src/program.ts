// Where urdfcheck is: found, or installed into an environment of the extension's own.
import { type ChildProcess, spawn } from "node:child_process";
import { access, constants } from "node:fs/promises";
import * as path from "node:path";
import * as vscode from "vscode";

const isWindows = process.platform === "win32";
const PROGRAM = isWindows ? "urdfcheck.exe" : "urdfcheck";
const SCRIPTS = isWindows ? "Scripts" : "bin";
// Milliseconds: the first start of a new environment compiles its modules.
const PATIENCE = 60_000;

export interface Outcome {
  code: number | null;
  output: string;
}

/** Runs a program to its end, without a shell and with nothing on its standard input. */
export function run(
  command: string,
  words: string[],
  options: { cwd?: string; patience?: number; onOutput?: (text: string) => void; token?: vscode.CancellationToken } = {},
): Promise<Outcome> {
  return new Promise((resolve) => {
    let output = "";
    const take = (data: Buffer): void => {
      output += data.toString();
      options.onOutput?.(data.toString());
    };
    let child: ChildProcess;
    try {
      child = spawn(command, words, { cwd: options.cwd, stdio: ["ignore", "pipe", "pipe"], timeout: options.patience ?? PATIENCE });
    } catch (error) {
      resolve({ code: null, output: String(error) });
      return;
    }
    options.token?.onCancellationRequested(() => child.kill());
    child.stdout?.on("data", take);
    child.stderr?.on("data", take);
    child.on("error", (error) => { resolve({ code: null, output: error.message }); });
    child.on("close", (code) => { resolve({ code, output }); });
  });
}

export class Programs {
  private known: string | undefined;

  constructor(private readonly context: vscode.ExtensionContext, private readonly log: vscode.LogOutputChannel) {}

  /** The program that can serve; undefined, and why in the log, if there is none. `anew`: whatever was found before. */
  async find(anew = false): Promise<string | undefined> {
    if (anew) this.known = undefined;
    this.known ??= await this.search();
    return this.known;
  }

  private async search(): Promise<string | undefined> {
    for (const candidate of this.candidates()) {
      if (path.isAbsolute(candidate) && !(await isExecutable(candidate))) continue;
      // Without the libraries of the server it says so and fails; with them it ends as nobody speaks.
      const { code, output } = await run(candidate, ["server"]);
      if (code === 0) {
        this.log.info(`urdfcheck is ${candidate}`);
        return candidate;
      }
      this.log.warn(`${candidate}: ${output.trim() || `exit code ${code}`}`);
    }
    return undefined;
  }

  private candidates(): string[] {
    const set = vscode.workspace.getConfiguration("urdfcheck").get("path", "");
    if (set) return [set];
    // What a folder brings along is run only where its author is trusted.
    const folders = vscode.workspace.isTrusted ? (vscode.workspace.workspaceFolders ?? []) : [];
    const own = folders.flatMap((folder) => [".venv", "venv"].map((name) => path.join(folder.uri.fsPath, name, SCRIPTS, PROGRAM)));
    return [...own, ...onPath(), path.join(this.environment, SCRIPTS, PROGRAM)];
  }

  private get environment(): string {
    return path.join(this.context.globalStorageUri.fsPath, "environment");
  }

  /** Installs urdfcheck into the extension's own environment; whether that went well. */
  async install(): Promise<boolean> {
    const settings = vscode.workspace.getConfiguration("urdfcheck");
    const python = settings.get("python", "") || (await this.findPython());
    if (!python) {
      void vscode.window.showErrorMessage("urdfcheck needs Python 3.10 or newer, and none was found. The setting urdfcheck.python can name it.");
      return false;
    }
    const requirement = settings.get("requirement", "urdfcheck[server]");
    await vscode.workspace.fs.createDirectory(this.context.globalStorageUri);
    const steps: [string, string[]][] = [
      [python, ["-m", "venv", this.environment]],
      [path.join(this.environment, SCRIPTS, "python"), ["-m", "pip", "install", "--disable-pip-version-check", "--upgrade", requirement]],
    ];
    const progress = { location: vscode.ProgressLocation.Notification, title: `Installing ${requirement}`, cancellable: true };
    return vscode.window.withProgress(progress, async (_, token) => {
      for (const [command, words] of steps) {
        this.log.info([command, ...words].join(" "));
        const done = await run(command, words, { patience: 0, onOutput: (text) => { this.log.append(text); }, token });
        if (token.isCancellationRequested) return false;
        if (done.code !== 0) {
          const last = done.output.trim().split("\n").pop() ?? "";
          void this.offerLog(`urdfcheck could not be installed: ${last}`);
          return false;
        }
      }
      return true;
    });
  }

  async offerLog(message: string): Promise<void> {
    if (await vscode.window.showErrorMessage(message, "Show the log")) this.log.show();
  }

  private async findPython(): Promise<string | undefined> {
    for (const name of isWindows ? ["py", "python"] : ["python3", "python"]) {
      const { code } = await run(name, ["-c", "import sys, venv; sys.exit(sys.version_info < (3, 10))"]);
      if (code === 0) return name;
    }
    return undefined;
  }
}

/** The program in the folders of the PATH. Relative ones are left out: they would be folders of the workspace. */
function onPath(): string[] {
  const folders = (process.env.PATH ?? "").split(path.delimiter).filter((folder) => path.isAbsolute(folder));
  return folders.map((folder) => path.join(folder, PROGRAM));
}

async function isExecutable(file: string): Promise<boolean> {
  return access(file, constants.X_OK).then(() => true, () => false);
}
