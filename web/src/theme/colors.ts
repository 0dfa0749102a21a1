// Colours for what is drawn by script: read from colors.css, their only home.
export function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
