// urdfcheck in VS Code: what is typed is checked by `urdfcheck server`, and the robot is beside it in 3D.
import * as vscode from "vscode";
import { isRobot } from "./documents";
import { ReportPanel } from "./panel";
import { Programs } from "./program";
import { useSchema } from "./schema";
import { Server } from "./server";
import { CheckTasks } from "./tasks";
import { Verdicts } from "./verdict";

let server: Server | undefined;

export function activate(context: vscode.ExtensionContext): void {
  const log = vscode.window.createOutputChannel("urdfcheck", { log: true });
  const programs = new Programs(context, log);
  const own = new Server(programs, log);
  const panel = new ReportPanel(context, own, log);
  own.showReport = (uri, card) => panel.show(vscode.Uri.parse(uri), card);
  server = own;
  const verdicts = new Verdicts(own);
  const tasks = new CheckTasks(programs, own);

  const commands: Record<string, () => unknown> = {
    "urdfcheck.open3d": () => {
      const document = vscode.window.activeTextEditor?.document;
      if (document && isRobot(document)) return panel.show(document.uri);
      return vscode.window.showInformationMessage("The robot of the active editor is shown in 3D: open a URDF or a xacro.");
    },
    "urdfcheck.checkWorkspace": () => tasks.run(),
    "urdfcheck.install": async () => { if (await programs.install()) await own.restart(); },
    "urdfcheck.restart": () => own.restart(),
    "urdfcheck.useSchema": () => useSchema(context, own),
  };
  const startFor = (document: vscode.TextDocument): void => { if (isRobot(document)) void own.start().then(() => verdicts.renew()); };
  context.subscriptions.push(
    log,
    ...Object.entries(commands).map(([name, command]) => vscode.commands.registerCommand(name, command)),
    vscode.tasks.registerTaskProvider("urdfcheck", tasks),
    ...verdicts.listen(),
    ...panel.listen(verdicts),
    vscode.workspace.onDidOpenTextDocument(startFor),
    vscode.workspace.onDidChangeConfiguration((event) => {
      const concerns = ["urdfcheck.path", "urdfcheck.arguments"].some((key) => event.affectsConfiguration(key));
      if (concerns && own.isRunning) void own.restart();
    }),
    vscode.workspace.onDidGrantWorkspaceTrust(() => { vscode.workspace.textDocuments.forEach(startFor); }),
  );
  vscode.workspace.textDocuments.forEach(startFor);
}

export function deactivate(): Promise<void> | undefined {
  return server?.stop();
}
