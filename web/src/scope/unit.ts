// The unit of a signal, by the end of its name: `X.setpoint_mm`, `sync_error_um`.
const units: Record<string, string> = { mm: 'mm', um: 'µm', deg: '°', rev: 'rev', rpm: 'rev/min', s: 's', percent: '%', n: 'N', nm: 'N·m' };

export function unitOf(name: string): string {
  if (name.endsWith('_n_m')) return 'N·m';
  return units[name.slice(name.lastIndexOf('_') + 1).toLowerCase()] ?? '';
}
