// The check of all that is in a folder, as a task whose output becomes problems.
import * as vscode from "vscode";
import type { Programs } from "./program";
import type { Server } from "./server";

const TYPE = "urdfcheck";

interface Definition extends vscode.TaskDefinition {
  arguments?: string[];
}

export class CheckTasks implements vscode.TaskProvider {
  constructor(private readonly programs: Programs, private readonly server: Server) {}

  /** The tasks that a list of all tasks shows: nobody is asked anything for it. */
  async provideTasks(): Promise<vscode.Task[]> {
    return makeTasks(await this.programs.find());
  }

  async resolveTask(task: vscode.Task): Promise<vscode.Task | undefined> {
    const program = await this.programs.find();
    const scope = typeof task.scope === "object" ? task.scope : vscode.workspace.workspaceFolders?.[0];
    return program === undefined || !scope ? undefined : makeTask(program, scope, task.definition as Definition);
  }

  /** Checks all folders, each in a terminal. */
  async run(): Promise<void> {
    for (const task of makeTasks(await this.server.findProgram())) await vscode.tasks.executeTask(task);
  }
}

function makeTasks(program: string | undefined): vscode.Task[] {
  if (program === undefined) return [];
  return (vscode.workspace.workspaceFolders ?? []).map((folder) => makeTask(program, folder, { type: TYPE }));
}

function makeTask(program: string, folder: vscode.WorkspaceFolder, definition: Definition): vscode.Task {
  const words = ["check", ...(definition.arguments ?? ["."]), "--format", "concise"];
  const execution = new vscode.ProcessExecution(program, words, { cwd: folder.uri.fsPath });
  const task = new vscode.Task(definition, folder, "check workspace", TYPE, execution, "$urdfcheck");
  task.group = vscode.TaskGroup.Test;
  return task;
}
