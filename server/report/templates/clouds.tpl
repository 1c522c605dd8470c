{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="clouds">Coloured clouds <span class="soft">every point in the colours of the cameras that see it</span></h2>
{{#CLOUD}}
<h3>{{LIDAR}} <span class="soft">capture {{CAPTURE}}: {{SHARE}}</span></h3>
<div class="pictures clouds">
{{#VIEW}}
<figure><a href="{{FILE}}"><img loading="lazy" decoding="async" src="{{FILE}}" alt="{{ALT}}"></a><figcaption>{{NAME}}</figcaption></figure>
{{/VIEW}}
</div>
<p class="hint">Green points are seen by no camera. <a href="{{PLY}}">The cloud as PLY</a></p>
{{/CLOUD}}
{{#OVERLAYS}}
<h3>The cloud in each camera's picture <span class="soft">coloured by distance</span></h3>
<div class="pictures clouds">
{{#OVERLAY}}
<figure><a href="{{FILE}}"><img loading="lazy" decoding="async" src="{{FILE}}" alt="{{LIDAR}} in the picture of {{CAMERA}}"></a><figcaption>{{CAMERA}}, capture {{CAPTURE}}: {{POINTS}} of {{LIDAR}} (<a href="{{PICTURE}}">picture alone</a>)</figcaption></figure>
{{/OVERLAY}}
</div>
<p class="hint">Edges of things must lie where the points change colour: a shift of one that grows towards the camera is an error of position, one that is the same everywhere an error of rotation.</p>
{{/OVERLAYS}}
{{#CLOUD_NOTE}}
<p class="hint" dir="auto">{{TEXT}}</p>
{{/CLOUD_NOTE}}
</section>
