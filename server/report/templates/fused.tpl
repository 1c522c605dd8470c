{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="refined" data-part="Refined">Joint refinement <span class="soft">what it moved, the most first</span></h2>
<p>{{SUMMARY}}</p>
<div class="scroll" tabindex="0" role="region" aria-labelledby="refined">
<table class="small">
<thead><tr><th scope="col">Sensor</th><th scope="col">Moved, mm</th><th scope="col">Turned, deg</th><th scope="col">in &sigma; of the pairs</th><th scope="col">&sigma; by the pairs, mm</th><th scope="col">&sigma; refined, mm</th>{{#VISITS_HEAD}}<th scope="col">From visit to visit, mm / deg</th>{{/VISITS_HEAD}}</tr></thead>
<tbody>
{{#SENSOR}}<tr><th scope="row">{{NAME}}</th><td>{{MM}}</td><td>{{DEG}}</td><td><span class="badge {{CLASS}}">{{SIGMAS}}</span></td><td>{{BEFORE}}</td><td>{{NOW}}</td>{{#VISITS}}<td>{{TEXT}}</td>{{/VISITS}}</tr>
{{/SENSOR}}
</tbody>
</table>
</div>
{{#HELD_BACK}}<p dir="auto"><span class="badge warn">held back</span> {{TEXT}}</p>
{{/HELD_BACK}}
{{#INFLUENTIAL}}<p dir="auto">{{TEXT}}</p>
{{/INFLUENTIAL}}
{{#CLOCK}}<p dir="auto">{{TEXT}}</p>
{{/CLOCK}}
{{#BENT}}<h3 id="bent">Lenses that bend beyond their model <span class="soft">the bend is taken out as far as it is known</span></h3>
<div class="scroll" tabindex="0" role="region" aria-labelledby="bent">
<table class="small">
<thead><tr><th scope="col">Camera</th><th scope="col">Model</th><th scope="col">Bends by, px</th><th scope="col">adds to &sigma;, mm / deg</th><th scope="col">In use, px</th>{{#HEAD}}<th scope="col">{{MODEL}}, px</th>{{/HEAD}}<th scope="col">Model to take</th></tr></thead>
<tbody>
{{#LENS}}<tr><th scope="row"><bdi>{{CAMERA}}</bdi></th><td class="text">{{MODEL}}</td><td>{{BEND}}</td><td>{{SIGMA}}</td><td>{{OWN}}</td>{{#TRIED}}<td>{{TEXT}}</td>{{/TRIED}}<td class="text">{{#BETTER}}<span class="badge warn">{{ADVICE}}</span>{{/BETTER}}{{#PLAIN}}{{ADVICE}}{{/PLAIN}}</td></tr>
{{/LENS}}
</tbody>
</table>
</div>
<p class="hint">Each model is fitted with a fifth of the captures left out, five times; the rms is that of the corners in the captures left out, so a model with more numbers gains nothing by itself.</p>
{{/BENT}}
<p class="hint">Each pair of sensors is calibrated by itself first; edges, residuals and loops on this page are about these pairs. Then everything that all sensors saw in a session, each corner, each plate and each pose of a tracker, is put into one estimate. The poses above, <code>rigcal lookup</code> and what robots receive are the refined ones.{{#VISITS_NOTE}} A sensor does not sit in the very same place on every visit: how far it was off from one to the next is counted in its &sigma;. One that goes on from visit to visit and does not come back is told where it was on the newest one. Few visits hardly tell that; where robots of its rig model are named, theirs count with it.{{/VISITS_NOTE}}</p>
</section>
