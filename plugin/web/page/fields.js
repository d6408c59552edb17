// A dialog: a field for each parameter of a filter that has an effect here.

// What the page does not have: selections, qualities; and what it always asks for, or has no place for.
const kLeftOut = new Set(['selected', 'weight', 'store_noise_height', 'result']);
const kMostEdges = 100;  // of a slider of sizes, logarithmic from 1 on

const plain = (text) => text.replace(/[*|]/g, '');

function element(name, properties) {
  return Object.assign(document.createElement(name), properties);
}

function inputOf(parameter) {
  const {kind, name, choices} = parameter;
  if (kind === 'choice') {
    const select = element('select', {name});
    for (const choice of choices) select.add(new Option(choice));
    select.selectedIndex = parameter.default;
    return select;
  }
  if (kind === 'bool') return element('input', {name, type: 'checkbox', checked: parameter.default});
  const input = element('input', {name, type: kind === 'int' || kind === 'float' ? 'number' : 'text', value: parameter.default});
  if (input.type === 'number') Object.assign(input, {step: kind === 'int' ? 1 : 'any', min: parameter.low, max: parameter.high ?? ''});
  return input;
}

/** A slider beside a text, of a size in edges or of a number with bounds; null: neither. */
function sliderOf({kind, high, low, label, defaultInWords}, input, note, sizes) {
  const maybeZero = defaultInWords.startsWith('0');  // which no logarithmic slider has
  if (kind === 'length' ? maybeZero : kind !== 'float' || high === null) return null;
  const slider = element('input', {type: 'range', step: 'any', ariaLabel: `${label}, slider`});
  if (kind === 'float') {
    Object.assign(slider, {min: low, max: high, value: input.value});
    slider.addEventListener('input', () => { input.value = Number(slider.value).toFixed(2); });
    input.addEventListener('input', () => { slider.value = input.value; });
    return slider;
  }
  const tell = () => {
    const edges = input.value.match(/^([\d.]+)e$/)?.[1];
    note.textContent = edges && sizes ? ` ${((100 * edges * sizes.meanEdge) / sizes.diagonal).toPrecision(2)} %` : '';
    if (edges) slider.value = Math.log(edges);
    slider.ariaValueText = `${input.value}${note.textContent}`;
  };
  Object.assign(slider, {min: 0, max: Math.log(kMostEdges), value: Math.log(6)});
  slider.addEventListener('input', () => {
    input.value = `${Math.exp(slider.value).toPrecision(2)}e`;
    tell();
  });
  input.addEventListener('input', tell);
  return slider;
}

/** Fills the fields with options, and with defaults where there are none. */
function fill(filter, form, options) {
  for (const {name, kind, choices, default: usual} of filter.parameters) {
    const input = form.elements[name], value = options[name] ?? usual;
    if (!input) continue;
    if (kind === 'bool') input.checked = value;
    else if (kind === 'choice') input.selectedIndex = typeof value === 'string' ? choices.indexOf(value) : value;
    else input.value = value;
    input.dispatchEvent(new Event('input', {bubbles: true}));  // its slider follows
  }
}

/** A box of presets, where all options have fields; null: there are none. */
function presetsOf(filter) {
  const presets = filter.presets.filter(({options}) => !Object.keys(options).some((name) => kLeftOut.has(name)));
  if (presets.length === 0) return null;
  const row = element('p', {className: 'row'}), box = element('select', {id: 'preset'});
  box.add(new Option('defaults'));
  for (const {name, purpose} of presets) box.add(new Option(`${name}: ${purpose}`, name));
  box.addEventListener('change', () => fill(filter, box.form, presets[box.selectedIndex - 1]?.options ?? {}));
  row.append(element('label', {htmlFor: box.id, textContent: 'Start from'}), box);
  return row;
}

/** The fields of a filter; lesser ones behind a summary. @param sizes  of the mesh, if there is one */
export function fieldsOf(filter, sizes) {
  const presets = presetsOf(filter), fields = presets ? [presets] : [], lesser = element('details', {});
  lesser.append(element('summary', {textContent: 'More'}));
  for (const parameter of filter.parameters) {
    if (kLeftOut.has(parameter.name)) continue;
    const row = element('div', {className: 'field', title: `${plain(parameter.help)}${parameter.unit ? ` (${parameter.unit})` : ''}`});
    const input = inputOf(parameter), note = element('span', {className: 'quiet'});
    input.id = `field-${parameter.name}`;
    const label = element('label', {htmlFor: input.id, textContent: parameter.label});
    label.append(note);
    row.append(label, input);
    const slider = parameter.isAdvanced ? null : sliderOf(parameter, input, note, sizes);
    if (slider) row.append(slider);
    if (parameter.isAdvanced) lesser.append(row);
    else fields.push(row);
  }
  return lesser.childElementCount > 1 ? [...fields, lesser] : fields;
}

/** What differs from the defaults. */
export function optionsOf(filter, form) {
  const options = {};
  for (const parameter of filter.parameters) {
    const input = form.elements[parameter.name];
    if (!input) continue;
    const value = parameter.kind === 'choice' ? input.selectedIndex
      : input.type === 'checkbox' ? input.checked
      : input.type === 'number' ? Number(input.value) : input.value.trim();
    if (value === parameter.default) continue;
    options[parameter.name] = parameter.kind === 'choice' ? parameter.choices[value]
      : parameter.kind === 'length' && value !== '' && !Number.isNaN(Number(value)) ? Number(value) : value;
  }
  return options;
}
