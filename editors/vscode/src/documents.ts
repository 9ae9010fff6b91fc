// Which documents are robots.
import * as vscode from "vscode";

const ROBOT_FILE = /\.(urdf|xacro|srdf|launch)$/i;
const ROBOT_ELEMENT = /<robot[\s>]/;
// The part of a file in which its first element is looked for.
const HEAD = 20_000;

/** Whether a document is a robot, a part of one or a launch file: what the server is started for. */
export function isRobot(document: vscode.TextDocument): boolean {
  if (document.uri.scheme !== "file") return false;
  if (ROBOT_FILE.test(document.uri.fsPath)) return true;
  return document.languageId === "xml" && ROBOT_ELEMENT.test(document.getText().slice(0, HEAD));
}

/** The folder that a document is in, else the first one that is open. */
export function folderOf(uri?: vscode.Uri): vscode.WorkspaceFolder | undefined {
  return (uri && vscode.workspace.getWorkspaceFolder(uri)) ?? vscode.workspace.workspaceFolders?.[0];
}
