// Small charts as SVG and HTML text; colours come from the style sheet.
'use strict';

const escape_html = (text) => String(text).replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);

function figure_text(value) {
    if (value === 0 || Number.isInteger(value)) return value.toLocaleString('en');
    const size = Math.abs(value);
    return size >= 1000 ? Math.round(value).toLocaleString('en') : size >= 0.001 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
}

// One line over its rounds, from 0 up, with its first and last value.
function line_chart(title, values) {
    const width = 220, height = 90, left = 4, bottom = 16;
    const most = Math.max(...values, 1e-12);
    const x = (i) => left + ((width - 2 * left) * i) / Math.max(values.length - 1, 1);
    const y = (v) => 6 + (height - bottom - 6) * (1 - v / most);
    const points = values.map((v, i) => `${x(i).toFixed(1)},${y(v).toFixed(1)}`).join(' ');
    const first = values[0], last = values[values.length - 1];
    const change = first > 1e-6 * most ? `${last <= first ? '−' : '+'}${Math.abs((100 * (last - first)) / first).toFixed(0)} %` : '';
    return `<figure class="chart"><figcaption>${escape_html(title)} <b>${change}</b></figcaption>` +
        `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${escape_html(title)} per round">` +
        `<line class="axis" x1="${left}" x2="${width - left}" y1="${height - bottom}" y2="${height - bottom}"/>` +
        `<polyline points="${points}"/><circle cx="${x(values.length - 1)}" cy="${y(last)}" r="3"/>` +
        `<text x="${left}" y="${height - 3}">${figure_text(first)}</text>` +
        `<text x="${width - left}" y="${height - 3}" text-anchor="end">${figure_text(last)} after ${values.length}</text></svg></figure>`;
}

// Dots over the frames of a scan: {value (null = not measured), group (a class of the style sheet)}.
function dot_chart(title, dots) {
    const width = 900, height = 170, left = 34, bottom = 18;
    const known = dots.map((d) => d.value).filter((v) => v !== null);
    if (!known.length) return '';
    const most = Math.max(...known), least = Math.min(...known), range = most - least || 1;
    const x = (i) => left + ((width - left - 6) * i) / Math.max(dots.length - 1, 1);
    const y = (v) => 8 + (height - bottom - 16) * (1 - (v - least) / range);
    const circles = dots.map((d, i) => (d.value === null ? '' : `<circle class="${d.group}" cx="${x(i).toFixed(1)}" cy="${y(d.value).toFixed(1)}" r="${d.group === 'kept' ? 3 : 1.8}"/>`));
    return `<svg class="dots" viewBox="0 0 ${width} ${height}" role="img" aria-label="${escape_html(title)}">` +
        `<line class="axis" x1="${left}" x2="${width}" y1="${height - bottom}" y2="${height - bottom}"/>` +
        `<text x="0" y="${y(most) + 4}">${most.toFixed(2)}</text><text x="0" y="${y(least) + 4}">${least.toFixed(2)}</text>` +
        `<text x="${left}" y="${height - 3}">frame 0</text><text x="${width}" y="${height - 3}" text-anchor="end">${dots.length - 1}</text>${circles.join('')}</svg>`;
}

// Rows with a bar for every column: rows [{name, values}], columns [{title, text(value)}].
function bar_table(rows, columns) {
    const most = columns.map((_, c) => Math.max(...rows.map((r) => r.values[c]), 1e-12));
    const cell = (row, c) => `<td class="bar"><i style="width:${((100 * row.values[c]) / most[c]).toFixed(1)}%"></i><span>${columns[c].text(row.values[c])}</span></td>`;
    return `<table><thead><tr><th>stage</th>${columns.map((c) => `<th>${c.title}</th>`).join('')}</tr></thead><tbody>` +
        rows.map((r) => `<tr><td>${escape_html(r.name)}</td>${columns.map((_, c) => cell(r, c)).join('')}</tr>`).join('') + '</tbody></table>';
}

// One bar of parts that make up a whole: parts [{name, value (0..1), color}].
function share_bar(parts) {
    const shown = parts.filter((p) => p.value > 0);
    return `<div class="shares">${shown.map((p) => `<i style="flex:${p.value};background:${p.color}"></i>`).join('')}</div><ul class="legend">` +
        shown.map((p) => `<li><i style="background:${p.color}"></i>${escape_html(p.name)} <b>${(100 * p.value).toFixed(1)} %</b></li>`).join('') + '</ul>';
}
