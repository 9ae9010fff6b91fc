// The report as a page of a panel.
import { createHash } from "node:crypto";

const POLICY = /(<meta http-equiv="Content-Security-Policy" content=")([^"]*)(">)/;

/**
 * Adds a script and a style to a report. Its policy, which allows nothing but its own scripts and style by their hashes, allows
 * these two as well and nothing else.
 */
export function makePage(report: string, script: string, style: string): string {
  const found = POLICY.exec(report);
  const [head, end] = [report.indexOf("</head>"), report.lastIndexOf("</body>")];
  if (!found || head < found.index || end < head) throw new Error("this is not a report of urdfcheck");
  const policy = allow(allow(found[2] ?? "", "script-src", script), "style-src", style);
  return [
    report.slice(0, found.index),
    `${found[1]}${policy}${found[3]}`,
    report.slice(found.index + found[0].length, head),
    // In the head, so that the page's own scripts measure what is shown.
    `<style>${style}</style>`,
    report.slice(head, end),
    `<script>${script}</script>`,
    report.slice(end),
  ].join("");
}

function allow(policy: string, kind: string, text: string): string {
  const hash = `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
  const parts = policy.split(";").map((part) => part.trim()).filter(Boolean);
  const own = parts.find((part) => part.startsWith(`${kind} `)) ?? kind;
  return [...parts.filter((part) => part !== own), `${own} ${hash}`].join("; ");
}
