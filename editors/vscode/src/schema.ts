// Completion and checks of urdfcheck.toml, by the extension Even Better TOML.
import * as vscode from "vscode";
import { run } from "./program";
import type { Server } from "./server";

const TOML = "tamasfe.even-better-toml";
const FILES = "(^|/)urdfcheck\\.toml$";

/** Writes the schema of the urdfcheck that is in use, and tells Even Better TOML where it is. */
export async function useSchema(context: vscode.ExtensionContext, server: Server): Promise<void> {
  if (!vscode.extensions.getExtension(TOML)) {
    await vscode.commands.executeCommand("workbench.extensions.search", TOML);
    return;
  }
  const program = await server.findProgram();
  if (program === undefined) return;
  const { code, output } = await run(program, ["config", "--schema"]);
  if (code !== 0) throw new Error(output);
  const file = vscode.Uri.joinPath(context.globalStorageUri, "urdfcheck.schema.json");
  await vscode.workspace.fs.writeFile(file, Buffer.from(output));
  const settings = vscode.workspace.getConfiguration("evenBetterToml.schema");
  const known = settings.inspect<Record<string, string>>("associations")?.globalValue ?? {};
  await settings.update("associations", { ...known, [FILES]: file.toString() }, vscode.ConfigurationTarget.Global);
}
