// The one home of number formats: sign always shown, decimals fixed, so that nothing jumps when digits change.
const minus = '−';
const mm_per_inch = 25.4;

export type DisplayUnit = 'mm' | 'inch';

/** `value` with its sign and so many decimals; what rounds to zero has a plus. */
export function signed(value: number, decimals: number): string {
  const digits = Math.abs(value).toFixed(decimals);
  return (value < 0 && Number(digits) !== 0 ? minus : '+') + digits;
}

export function plain(value: number, decimals: number): string {
  return value.toFixed(decimals).replace('-', minus);
}

/** A coordinate in the unit of the display: three decimals metric, four inch, three of an angle. */
export function coordinate(value: number, unit: 'mm' | 'deg', display: DisplayUnit): string {
  if (unit === 'deg') return signed(value, 3);
  return display === 'inch' ? signed(value / mm_per_inch, 4) : signed(value, 3);
}

export function unitName(unit: 'mm' | 'deg', display: DisplayUnit): string {
  if (unit === 'deg') return '°';
  return display === 'inch' ? 'in' : 'mm';
}

/** A number in the unit of the display, in mm (or degrees). */
export function inMillimetres(value: number, unit: 'mm' | 'deg', display: DisplayUnit): number {
  return unit === 'mm' && display === 'inch' ? value * mm_per_inch : value;
}

/** A number in mm (or degrees), in the unit of the display. */
export function inDisplay(value: number, unit: 'mm' | 'deg', display: DisplayUnit): number {
  return unit === 'mm' && display === 'inch' ? value / mm_per_inch : value;
}

/** What was typed in the unit of the display, in mm (or degrees); null: no number. */
export function typed(text: string, unit: 'mm' | 'deg', display: DisplayUnit): number | null {
  const value = Number(text.trim().replace(minus, '-').replace(',', '.'));
  if (text.trim() === '' || !Number.isFinite(value)) return null;
  return inMillimetres(value, unit, display);
}

/** A length as one edits it: no sign of plus, in the unit of the display. */
export function editable(value: number, display: DisplayUnit): string {
  return display === 'inch' ? (value / mm_per_inch).toFixed(4) : value.toFixed(3);
}

export function percent(value: number): string {
  return `${Math.round(value)} %`;
}

/** Minutes and seconds. */
export function duration(seconds: number): string {
  const all = Math.max(0, Math.round(seconds));
  const pad = (n: number) => String(n).padStart(2, '0');
  const hours = Math.floor(all / 3600);
  const rest = `${pad(Math.floor((all % 3600) / 60))}:${pad(all % 60)}`;
  return hours > 0 ? `${hours}:${rest}` : rest;
}

export function age(seconds: number): string {
  return seconds < 60 ? `${seconds.toFixed(1)} s` : duration(seconds);
}
