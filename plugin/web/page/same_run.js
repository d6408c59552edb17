// The same run in Python and in the shell, and as a recipe.

const kFunctions = {apply_coord_spectral_denoise: ['denoise_mesh', 'denoise'],
                    apply_coord_spectral_filter_fractional: ['filter_mesh', 'filter']};

const inPython = (value) => (typeof value === 'boolean' ? (value ? 'True' : 'False') : JSON.stringify(value));
const keywords = (options, write) => Object.entries(options).map(([name, value]) => `, ${name}=${write(value)}`).join('');

/** A length as pymeshlab takes it. */
function forMeshSet(value, isLength, sizes) {
  if (!isLength) return inPython(value);
  const [, number, unit] = String(value).match(/^([-\d.]+)\s*(%|e)?$/) ?? [];
  if (unit === '%') return `pymeshlab.PercentageValue(${number})`;
  return `pymeshlab.PureValue(${unit === 'e' ? number * sizes.meanEdge : value})`;
}

export function sameRun(filter, options, name, sizes) {
  const [stem, ending] = [name.replace(/\.[^.]+$/, ''), name.split('.').pop()];
  const known = kFunctions[filter.pythonName];
  if (!known) {
    const lengths = new Set(filter.parameters.filter((one) => one.kind === 'length').map((one) => one.name));
    const given = Object.entries(options).map(([key, value]) => `${key}=${forMeshSet(value, lengths.has(key), sizes)}`).join(', ');
    return `# Python\nimport pymeshlab, meshlab_spectral\nmeshlab_spectral.load()\nms = pymeshlab.MeshSet()\nms.load_new_mesh(${JSON.stringify(name)})\nms.${filter.pythonName}(${given})`;
  }
  const [method, command] = known;
  const flags = Object.entries(options).map(([key, value]) => {
    const flag = key.replaceAll('_', '-');
    return typeof value === 'boolean' ? ` --${value ? '' : 'no-'}${flag}` : ` --${flag}='${value}'`;
  }).join('');
  const recipe = Object.entries(options).map(([key, value]) => `${key} = ${JSON.stringify(value)}`).join('\n');
  return `# Python\nfrom meshlab_spectral import ${method}\nX, report = ${method}(V, F${keywords(options, inPython)})\n\n` +
    `# shell\nmeshlab-spectral ${command} '${name}' '${stem}_${command === 'denoise' ? 'denoised' : 'filtered'}.${ending}'${flags}\n\n# recipe.toml\n[${command}]\n${recipe}`;
}
