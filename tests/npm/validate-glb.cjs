// Prints the issues that Khronos' validator finds in a GLB file; exit code 1 when there are errors or warnings.
const fs = require('fs');
const validator = require('gltf-validator');

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then((report) => {
    const { numErrors, numWarnings, messages } = report.issues;
    for (const m of messages) console.log(`${['error', 'warning', 'info', 'hint'][m.severity]} ${m.code} at ${m.pointer || m.offset}: ${m.message}`);
    console.log(`${numErrors} errors, ${numWarnings} warnings`);
    process.exit(numErrors + numWarnings > 0 ? 1 : 0);
});
