// The declarations of the package for TypeScript, from the tables of plugin/core/contract as the module
// has them; kinds of entries of reports come from runs on a torus.

const kSignals = {apply_color_spectral_filter_per_vertex: 3, apply_scalar_spectral_filter_per_vertex: 1};
// With these, where a filter has them, its report has all entries that there may be.
const kMore = {spectrum: 'truncated', basis_size: 20, steps: 1, form: 'sphere'};

const kHead = `// Written by plugin/web/npm/types.mjs from the tables in plugin/core/contract: edit those.

/** Numbers, in rows as those of BufferAttribute.array in three.js. */
export type Numbers = ArrayLike<number> & Iterable<number>;
/** A length: a number in the units of the mesh, \`5%\` of its diagonal, or \`6e\`, mean edges. */
export type Length = number | string;

export interface Context {
  /** Ends the run; the promise is then rejected with \`signal.reason\`. */
  signal?: AbortSignal;
  /** @param fraction  done, 0 to 1 */
  progress?: (fraction: number, stage: string) => void;
  /** Bytes that the module may take; 0: as many as the browser gives, up to 4 GiB. */
  memoryLimit?: number;
  /** n: 1 for selected vertices, for the option \`selected\`. */
  selected?: Numbers;
  /** A quality for each of n vertices, or red, green and blue from 0 to 255. */
  values?: Numbers;
  /** Pairs of a frequency, w = feature size / wavelength, and its gain, in place of a transfer function. */
  gain?: Numbers;
}

export interface Result<Report> {
  /** n x 3, in rows; missing if the filter moves no vertex. */
  vertices?: Float64Array;
  /** n x 3, input minus result, with \`result\` \`details\`. */
  details?: Float64Array;
  /** New qualities or colours, or heights of noise. */
  values?: Float64Array;
  /** n x k harmonics, in rows. */
  basis?: Float64Array;
  /** Lengths are in the units of the mesh. */
  report: Report;
  /** The report as lines for a log. */
  text: string;
  /** What was found and done, one line; empty if the numbers say it all. */
  summary: string;
  /** Problems that were not errors, and what to do about them. */
  warnings: string[];
  /** For each, what it is about, such as \`thin_parts\`. */
  warningCodes: string[];
}

/** What a filter rejects. The mesh it was given is never changed. */
export class SpectralError extends Error {
  name: 'OptionError' | 'MeshError' | 'MemoryLimitError' | 'SolverError' | 'Error';
  /** Such as \`no_faces\`. */
  code: string;
  /** The largest possible value, such as the number of vertices that fit in memory; 0: none. */
  limit: number;
}

`;

const kTail = `
export interface Parameter {
  name: string;
  label: string;
  help: string;
  unit: string;
  kind: 'bool' | 'int' | 'float' | 'length' | 'choice' | 'str';
  /** Of a choice its index. */
  default: boolean | number | string;
  defaultInWords: string;
  isAdvanced: boolean;
  low: number;
  high: number | null;
  isLowOpen: boolean;
  choices: string[];
}

export interface Filter {
  name: string;
  pythonName: keyof Filters;
  help: string;
  parameters: Parameter[];
  /** Options for a purpose; of all others the defaults hold. */
  presets: {name: string; purpose: string; options: Record<string, boolean | number | string>}[];
  report: {name: string; meaning: string; isAlways: boolean}[];
}

/** All filters, as tables for a dialog. */
export function filters(): Promise<Filter[]>;

/**
 * Applies a filter.
 * @param V  n x 3 positions, in rows
 * @param F  m x 3 vertex indices, in rows; null: each three vertices are a triangle
 * @throws SpectralError
 */
export function applyFilter<Name extends keyof Filters>(name: Name, V: Numbers, F?: Numbers | null,
  options?: Filters[Name]['options'], context?: Context): Promise<Result<Filters[Name]['report']>>;

type Moved<Name extends keyof Filters> =
  Promise<Result<Filters[Name]['report']> & {vertices: Float64Array}>;

/** Finds which noise a mesh has, and removes it: \`applyFilter('apply_coord_spectral_denoise', ...)\`. */
export function denoiseMesh(V: Numbers, F?: Numbers | null,
  options?: Filters['apply_coord_spectral_denoise']['options'], context?: Context):
  Moved<'apply_coord_spectral_denoise'>;

/** Filters by the size of details: \`applyFilter('apply_coord_spectral_filter_fractional', ...)\`. */
export function filterMesh(V: Numbers, F?: Numbers | null,
  options?: Filters['apply_coord_spectral_filter_fractional']['options'], context?: Context):
  Moved<'apply_coord_spectral_filter_fractional'>;

/**
 * Normals, k x 3, of a shape whose vertices have moved. Those whose triangles have not moved are kept.
 * @param which  m x 3 indices of each corner's normal; as F if there is one for each vertex
 */
export function followingNormals(before: Numbers, after: Numbers, F: Numbers, normals: Numbers,
  which?: Numbers): Promise<Float64Array>;
`;

const plain = (text) => text.replace(/\*|\|/g, '').replace(/\*\//g, '* /');
const capital = (text) => text[0].toUpperCase() + text.slice(1);

function wrapped(text, indent) {
  const lines = [''];
  for (const word of text.split(/\s+/)) {
    if (`${lines.at(-1)} ${word}`.length > 100 - indent.length) lines.push('');
    lines[lines.length - 1] += `${lines.at(-1) ? ' ' : ''}${word}`;
  }
  const start = lines.length > 1 ? `/**\n${indent} * ` : '/** ';
  return `${indent}${start}${lines.join(`\n${indent} * `)}${lines.length > 1 ? `\n${indent} */` : ' */'}\n`;
}

const typeOf = ({kind, choices}) =>
  kind === 'choice' ? choices.map((choice) => `'${choice}'`).join(' | ')
  : {bool: 'boolean', int: 'number', float: 'number', length: 'Length', str: 'string'}[kind];

function optionOf(parameter) {
  const usual = parameter.kind === 'choice' ? parameter.choices[parameter.default] : parameter.default;
  const inWords = parameter.defaultInWords || JSON.stringify(usual);
  const text = `${plain(parameter.help)} ${parameter.unit ? `${capital(parameter.unit)}. ` : ''}Default: ${inWords}.`;
  return `${wrapped(text, '      ')}      ${parameter.name}?: ${typeOf(parameter)};\n`;
}

function torus(rings = 12) {
  const V = [], F = [];
  for (let i = 0; i < rings; i++)
    for (let j = 0; j < rings; j++) {
      const u = (i * 2 * Math.PI) / rings, v = (j * 2 * Math.PI) / rings, r = 1 + 0.7 * Math.cos(v);
      V.push(r * Math.cos(u), r * Math.sin(u), 0.7 * Math.sin(v));
      const a = i + rings * j, b = ((i + 1) % rings) + rings * j;
      const [c, d] = [b, a].map((corner) => (corner + rings) % rings ** 2);
      F.push(a, b, c, a, c, d);
    }
  return {V, F};
}

async function kindsOf(filter, applyFilter) {
  const {V, F} = torus();
  const columns = kSignals[filter.pythonName] ?? 1;
  const values = V.slice(0, (V.length / 3) * columns).map(Math.abs);
  const known = new Set(filter.parameters.map((one) => one.name));
  const more = Object.fromEntries(Object.entries(kMore).filter(([name]) => known.has(name)));
  const kinds = {};
  for (const options of [{}, more]) {
    const {report} = await applyFilter(filter.pythonName, V, F, options, {values});
    for (const [name, value] of Object.entries(report))
      kinds[name] = typeof value === 'object' ? 'Float64Array' : typeof value;
  }
  return kinds;
}

/** The text of index.d.ts. @param module  index.js */
export async function declarations({filters, applyFilter}) {
  let text = `${kHead}/** Options and reports of all filters, by their names in Python. */\nexport interface Filters {\n`;
  for (const filter of await filters()) {
    const kinds = await kindsOf(filter, applyFilter);
    const entries = filter.report.map(({name, meaning, isAlways}) =>
      `${wrapped(`${capital(meaning)}.`, '      ')}      ${name}${isAlways ? '' : '?'}: ${kinds[name]};\n`);
    text += `${wrapped(plain(`${filter.name}. ${filter.help}`), '  ')}  ${filter.pythonName}: {\n`;
    text += `    options: {\n${filter.parameters.map(optionOf).join('')}    };\n`;
    text += `    report: {\n${entries.join('')}    };\n  };\n`;
  }
  return `${text}}\n${kTail}`;
}
