// The colours of the page, as the scene needs them.
import { Color } from "three";

const NAMES = { page: "--well", soft: "--soft", link: "--link" } as const;

export type Theme = Record<keyof typeof NAMES, Color> & { dark: boolean };

/** The custom properties of the page as they are now; a probe element makes the browser resolve them. */
export function themeOf(section: HTMLElement): Theme {
  const probe = document.createElement("span");
  section.append(probe);
  const theme: Partial<Theme> = {};
  for (const [name, property] of Object.entries(NAMES)) {
    probe.style.color = `var(${property}, gray)`;
    theme[name as keyof typeof NAMES] = new Color(getComputedStyle(probe).color);
  }
  probe.remove();
  const { r, g, b } = theme.page!;
  return { ...(theme as Theme), dark: 0.2126 * r + 0.7152 * g + 0.0722 * b < 0.2 };
}

/** Calls back whenever the page may have changed its colours. */
export function onTheme(changed: () => void): void {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  document.addEventListener("uc:theme", changed);
  new MutationObserver(changed).observe(document.documentElement, { attributeFilter: ["data-theme"] });
}
