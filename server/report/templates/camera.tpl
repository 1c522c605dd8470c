{{%AUTOESCAPE context="HTML"}}
<details class="card edge camera"{{#OPEN}} open{{/OPEN}}>
<summary><h2>{{CAMERA}}</h2> <span class="soft">{{SUMMARY}}</span>{{#WARNED}} <span class="badge warn">{{COUNT}}</span> <span class="soft">{{FIGURES}}</span>{{/WARNED}}</summary>
<div id="{{ANCHOR}}" class="body">
{{#ADVICE}}<div class="diagnosis warn">{{#ONE}}<p class="what">{{TEXT}}</p>{{/ONE}}</div>{{/ADVICE}}
<div class="plots camera-plots">
<figure class="plot tall">
<figcaption><strong>Where corners were seen</strong> {{COVERED}} % of the fields of the picture have one</figcaption>
<svg class="map picture" viewBox="0 0 360 {{MAP_HEIGHT}}" role="img" aria-label="Fields of the picture by the number of corners seen there: {{COVERED}} percent have one">
<svg x="0" y="0" width="360" height="{{MAP_HEIGHT}}" viewBox="0 0 {{COLUMNS}} {{ROWS}}" preserveAspectRatio="none">
{{#HEAT}}<path class="heat{{LEVEL}}" d="{{D}}"/>{{/HEAT}}
</svg>
</svg>
<p class="legend small">Corners in a field: {{#HEAT_KEY}}<span class="key heat{{LEVEL}}">{{TEXT}}</span>{{/HEAT_KEY}}</p>
</figure>
{{#VECTORS}}
<figure class="plot tall">
<figcaption><strong>Residual of every corner</strong> from where it was seen, {{MAGNIFIED}} times as long; {{DRAWN}}</figcaption>
<svg class="map picture" viewBox="0 0 360 {{MAP_HEIGHT}}" role="img" aria-label="Residual vectors on the picture">
<path class="usual" d="{{USUAL}}"/>
{{#FAR}}<path class="far" d="{{D}}"/>{{/FAR}}
{{#MEANS}}<path class="means" d="{{D}}"/>{{/MEANS}}
</svg>
<p class="legend small"><span class="key usual">a corner</span><span class="key far">longer than 3 &sigma; (normal: 1.1 %)</span><span class="key means">mean of its surroundings: short, unless the camera model does not fit</span></p>
</figure>
{{/VECTORS}}
{{#HISTOGRAM}}
<figure class="plot">
<figcaption><strong>How residuals are spread</strong> across and down the picture, &sigma; {{SIGMA_PX}} px; curve: normal distribution</figcaption>
<svg class="map" viewBox="0 0 360 190" role="img" aria-label="Histogram of the residuals against the normal distribution; {{BEYOND}} percent are beyond three sigma">
<path class="spread" d="{{BARS}}"/><path class="normal" d="{{CURVE}}"/>
<path class="axis" d="M0 165h360"/><path class="limit" d="{{LIMITS}}"/><text x="{{LOW}}" y="9" text-anchor="middle">-3 &sigma;</text><text x="{{HIGH}}" y="9" text-anchor="middle">3 &sigma;</text>
{{#TICK}}<text x="{{X}}" y="182" text-anchor="middle">{{TEXT}}</text>{{/TICK}}
</svg>
<p class="legend small">Axis in px. {{BEYOND}} % are beyond 3 &sigma; (normal: 0.27 %); the longest residual is {{WORST_PX}} px.</p>
</figure>
{{/HISTOGRAM}}
{{#STAND}}
<figure class="plot">
<figcaption><strong>How the boards stood</strong> tilt against the line of sight, deg, and distance</figcaption>
<div class="stand">
<svg class="compass" viewBox="0 0 200 200" role="img" aria-label="Tilt of each board">
{{#RING}}<circle class="ring" cx="100" cy="100" r="{{R}}"/><text x="103" y="{{Y}}">{{TEXT}}&deg;</text>{{/RING}}
<path class="ring" d="M100 12v176M12 100h176"/>
{{#DOT}}<circle class="dot" cx="{{X}}" cy="{{Y}}" r="3.4"><title>{{TITLE}}</title></circle>{{/DOT}}
</svg>
<svg class="strip" viewBox="0 0 240 60" role="img" aria-label="Distance of each board">
<path class="axis" d="M10 34h215"/>
{{#MARK}}<text x="{{X}}" y="50" text-anchor="middle">{{TEXT}}</text>{{/MARK}}
{{#DOT}}<circle class="dot" cx="{{ALONG}}" cy="{{ROW}}" r="3"><title>{{TITLE}}</title></circle>{{/DOT}}
</svg>
</div>
<p class="legend small">Right: the board's right side is nearer. Down: its lower side. Dots all around and at several distances pin the focal length.</p>
</figure>
{{/STAND}}
</div>
{{#WORST_VIEWS}}
<h3>Pictures that fit worst <span class="soft">dot: a corner as seen; line: towards where the solved camera puts it</span></h3>
<div class="views">
{{#VIEW}}
<figure><a href="evidence/{{FILE}}"><svg class="zoom" viewBox="{{CROP}}" role="img" aria-label="Corners of capture {{CAPTURE}} and where the solved camera puts them"><foreignObject x="0" y="0" width="{{WIDTH}}" height="{{HEIGHT}}"><img loading="lazy" src="evidence/{{FILE}}" width="{{WIDTH}}" height="{{HEIGHT}}" alt=""></foreignObject><path class="shifts" d="{{SHIFTS}}"/><path class="seen" d="{{SEEN}}"/></svg></a><figcaption>Capture <bdi>{{CAPTURE}}</bdi>: rms {{RMS}} px; lines {{MAGNIFIED}} times as long</figcaption></figure>
{{/VIEW}}
</div>
{{/WORST_VIEWS}}
{{#UNSOLVED}}<p class="hint">The camera was not solved: there are no residuals to draw.</p>{{/UNSOLVED}}
{{#UNCERTAINTY}}
<h3>How certain projections are <span class="soft">one &sigma;, in the direction that is known worst</span></h3>
<div class="plots camera-plots certainty">
{{#MAP}}
<figure class="plot tall">
<figcaption><strong>{{TITLE}}</strong> {{FIGURES}}</figcaption>
{{>FIELD_MAP}}
</figure>
{{/MAP}}
</div>
<p class="hint">By the covariance of the intrinsics. What a small turn and shift of the camera would make good at all corners does not count: it belongs to the camera's pose.{{#HATCHED}} Where fields are hatched the lens is a guess: hold the board there in the next session.{{/HATCHED}}</p>
{{/UNCERTAINTY}}
{{#NO_UNCERTAINTY}}
<h3>How certain projections are</h3>
<p class="hint">{{TEXT}}</p>
{{/NO_UNCERTAINTY}}
{{#INTRINSICS}}
<h3>Intrinsics <span class="soft">{{MODEL}}; {{SIGMA_FROM}}</span></h3>
<dl class="values">{{#VALUE}}<div><dt>{{NAME}}</dt><dd>{{VALUE}} {{UNIT}} <span class="soft">{{SIGMA}}</span></dd></div>{{/VALUE}}</dl>
{{/INTRINSICS}}
<p class="hint">{{#EDGE}}From the edge {{FROM}} &rarr; {{TO}} (<bdi>{{METHOD}}</bdi>). {{/EDGE}}{{#OTHERS}}{{TEXT}} {{/OTHERS}}<a href="{{FILE}}" download>Corners and residuals as JSON</a></p>
</div>
</details>
