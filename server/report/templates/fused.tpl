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
<p class="hint">Each pair of sensors is calibrated by itself first; edges, residuals and loops on this page are about these pairs. Then everything that all sensors saw in a session, each corner, each plate and each pose of a tracker, is put into one estimate. The poses above, <code>rigcal lookup</code> and what robots receive are the refined ones.{{#VISITS_NOTE}} A sensor does not sit in the very same place on every visit: how far it was off from one to the next is counted in its &sigma;. Few visits hardly tell that; where robots of its rig model are named, theirs count with it.{{/VISITS_NOTE}}</p>
</section>
