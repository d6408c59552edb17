// The core's advice names filters of MeshLab, which the page does not have: here it says what they do.

const kWords = [
  [/ \('Simplification: [^']*'\), or raise the memory limit/, ', or filter it in tiles with the Python package'],
  [/apply 'Simplification: [^']*' first/, 'simplify it first'],
  [/apply 'Remove Zero Area Faces' or 'Remeshing: [^']*' first/, 'remesh it first'],
  [/apply 'Remove Isolated pieces [^']*' first/, 'remove them first'],
  [/apply 'Merge Close Vertices' and 'Remove Duplicate Faces'/, 'merge close vertices and remove duplicate faces'],
  [/apply 'Merge Close Vertices' first/, 'merge close vertices first'],
  [/, e\.g\. with '[^']*'(?: or '[^']*')?$/, ''],
  [/, e\.g\. with 'Conditional Vertex Selection' .*$/, ''],
  [/load or create a mesh first/, 'open another file'],
];

export const inOwnWords = (text) => kWords.reduce((changed, [theirs, ours]) => changed.replace(theirs, ours), text);
